"""Every program that the project ships can be imported, and every example runs."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("benchmarks", "examples", "experiments", "tools")
FILES = [file for folder in FOLDERS for file in (ROOT / folder).rglob("*.py")]
PROGRAMS = [str(file.relative_to(ROOT)) for file in sorted(FILES, key=lambda f: (f.parent, f))]
"""Folder by folder."""
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
path, problems, before = sys.path[1:], {}, None
for program in programs:
    file = os.path.join(root, program)
    if (folder := os.path.dirname(file)) != before:
        for name, module in list(sys.modules.items()):  # another folder may have one of that name
            if before and (getattr(module, "__file__", None) or "").startswith(before + os.sep):
                del sys.modules[name]
        before = folder
    sys.path[:] = [folder, root, *path]
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


QUICK = {"own_model.py": ("--episodes", "40", "--epochs", "1")}
"""Arguments of examples that would take their time without."""
NAMED = "".join(
    path.read_text("utf-8")
    for folder in ("foreign", "learning")
    for path in (ROOT / "tests" / folder).glob("test_*.py")
)
EXAMPLES = [f for f in sorted((ROOT / "examples").glob("*.py")) if f'"{f.name}"' not in NAMED]
"""Examples that no test of their own runs."""


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_runs(example: Path, run: Callable[..., CompletedProcess[str]]) -> None:
    done = run(str(example), *QUICK.get(example.name, ()))
    assert done.returncode == 0, done.stderr
