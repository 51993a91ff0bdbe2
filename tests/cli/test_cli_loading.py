"""What each verb loads: a command that computes nothing must not wait for what computes."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from cli_runs import TOY

ENGINE = {"jinja2", "numpy", "pyarrow", "scipy", "scipy.special"}
HEAVY = {*ENGINE, "mujoco", "torch"}

AUDIT = ["--baseline", "a", "--repair", "b", "--fault", "gain:scale=2"]

MAY_LOAD: dict[str, tuple[set[str], list[list[str]]]] = {
    "help": (set(), [["--help"], ["audit", "--help"]]),
    "help of the quadrotor": ({"numpy"}, [["audit", "quadrotor", "--help"]]),
    "lists": (
        {"numpy", "scipy"},
        [["train", "quadrotor", "--list"], ["reproduce", "--judge"]],
    ),
    "mistakes": (
        ENGINE,
        [
            ["report", "nowhere"],
            ["audit", "quadcopter", *AUDIT],
            ["check", TOY, "--variants", "a"],
            ["trace", TOY, "--variant", "a"],
        ],
    ),
}
"""What some commands, one after the other in one process, may load."""

CODE = """
import json, sys
from faultpath.cli.main import main
heavy, commands = map(json.loads, sys.argv[1:])
for command in commands:
    sys.argv = ["faultpath", *command]
    try:
        main()
    except SystemExit as stop:
        assert stop.code in (0, 2), (command, stop.code)
print()
print(json.dumps([name for name in heavy if name in sys.modules]))
"""


@pytest.mark.parametrize(("allowed", "commands"), MAY_LOAD.values(), ids=MAY_LOAD)
def test_a_verb_loads_only_what_it_needs(
    allowed: set[str], commands: list[list[str]], tmp_path: Path
) -> None:
    line = [sys.executable, "-c", CODE, json.dumps(sorted(HEAVY)), json.dumps(commands)]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert set(json.loads(done.stdout.splitlines()[-1])) <= allowed
