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

MAY_LOAD = {
    "help": (["--help"], set[str]()),
    "help of a verb": (["audit", "--help"], set[str]()),
    "models": (["train", "quadrotor", "--list"], {"numpy", "scipy"}),
    "no such run": (["report", "nowhere"], ENGINE),
    "help of the quadrotor": (["audit", "quadrotor", "--help"], {"numpy"}),
    "no such system": (["audit", "quadcopter", *AUDIT], ENGINE),
    "nothing to check": (["check", TOY, "--variants", "a"], ENGINE),
    "nothing to trace": (["trace", TOY, "--variant", "a"], ENGINE),
    "claims": (["reproduce", "--judge"], {"numpy", "scipy"}),
}

CODE = """
import json, sys
from faultpath.cli.main import main
heavy = json.loads(sys.argv.pop(1))
try:
    main()
except SystemExit as stop:
    assert stop.code in (0, 2), stop.code
print()
print(json.dumps([name for name in heavy if name in sys.modules]))
"""


@pytest.mark.parametrize(("command", "allowed"), MAY_LOAD.values(), ids=MAY_LOAD)
def test_a_verb_loads_only_what_it_needs(
    command: list[str], allowed: set[str], tmp_path: Path
) -> None:
    line = [sys.executable, "-c", CODE, json.dumps(sorted(HEAVY)), *command]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert set(json.loads(done.stdout.splitlines()[-1])) <= allowed
