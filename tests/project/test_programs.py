"""Every program that the project ships can be imported, and says what it takes."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("benchmarks", "examples", "experiments", "tools")
PROGRAMS = sorted(
    str(file.relative_to(ROOT)) for folder in FOLDERS for file in (ROOT / folder).rglob("*.py")
)
PACKAGES = {
    *("Basilisk", "do_mpc", "gymnasium", "jax", "lerobot", "motulator", "mujoco", "pytorch_mppi"),
    *("opendbc", "rotorpy", "stable_worldmodel", "tensordict", "torch", "torchrl", "torchvision"),
    "wpimath",
}
"""Packages of others that a program may need and an environment may lack."""
CODE = """
import json, os, runpy, sys
from contextlib import redirect_stdout
from importlib.metadata import PackageNotFoundError
from io import StringIO

root, programs = sys.argv[1], json.loads(sys.argv[2])
path, problems = sys.path[1:], {}
for program in programs:
    file = os.path.join(root, program)
    sys.path[:] = [os.path.dirname(file), root, *path]
    with open(file) as source:
        takes_options = "import argparse" in source.read()
    sys.argv = [file, "--help"] if takes_options else [file]
    problem = ["", ""]
    try:
        with redirect_stdout(StringIO()) as out:
            runpy.run_path(file, run_name="__main__" if takes_options else "imported")
    except ModuleNotFoundError as error:
        problem = ["lacks", error.name.partition(".")[0]]
    except PackageNotFoundError as error:
        problem = ["lacks", error.name]
    except SystemExit as end:
        if end.code or not out.getvalue().startswith("usage: "):
            problem = ["ends with", str(end.code)]
    except Exception as error:
        problem = ["fails", f"{type(error).__name__}: {error}"]
    problems[program] = problem
    for name, module in list(sys.modules.items()):  # another program may have one of that name
        if (getattr(module, "__file__", None) or "").startswith(os.path.dirname(file) + os.sep):
            del sys.modules[name]
print(json.dumps(problems))
"""


def test_every_program_can_be_imported_and_says_what_it_takes(tmp_path: Path) -> None:
    """All are run by one process: libraries take longer than they do."""
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(ROOT), json.dumps(PROGRAMS)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    problems = json.loads(done.stdout.splitlines()[-1])
    assert set(problems) == set(PROGRAMS)
    wrong = {program: problem for program, problem in problems.items() if problem[0]}
    lacking = [["lacks", package] for package in PACKAGES]
    assert {program: problem for program, problem in wrong.items() if problem not in lacking} == {}
