"""Repeat some trials of every reference run, and run those again that do not repeat.

    python tools/references.py            run all again that are stale, the quickest first
    python tools/references.py NAME ...   run these, stale or not
    python tools/references.py --list     say which are stale, and how long each took
    python tools/references.py --list --foreign    the same, also where other packages are needed

Runs fly from a checkout of the last commit, in `build/references`. Each becomes the reference as
soon as it ends; one that was cut short is resumed. `carry-over`, `state-errors` and `paper` have
commands of their own, which their pages show.
"""

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

import documents
import repeats
from blocks import OUTCOMES, PROVENANCE, REFERENCE, ROOT, Repeats, Run, load

from faultpath.run.provenance import processor

TREE = ROOT / "build" / "references"
KEPT = ROOT / "build" / "repeats"
"""Where what a sample was repeated by is kept, by the name of the run."""
APART = ("carry-over", "state-errors", "paper")
SYSTEMS = {
    "basilisk": "Basilisk",
    "do_mpc": "do_mpc",
    "openpilot": "opendbc",
    "rotorpy": "rotorpy",
    "stable_worldmodel": "stable_worldmodel",
    "wpilib": "wpimath",
}
"""Packages that examples need, by how the names of these begin; `make test-foreign` has them."""


def main() -> None:
    """Carry out the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--list", action="store_true", help="fly nothing")
    parser.add_argument(
        "--foreign",
        action="store_true",
        help="with --list: also in other environments, which load slowly",
    )
    options = parser.parse_args()
    runs = by_time()
    if unknown := sorted({*options.names} - {*runs}):
        parser.error(f"no reference run is called {unknown[0]}: there are {', '.join(runs)}")
    if options.list:
        show(runs.values(), foreign=options.foreign)
        return
    chosen = options.names or [
        name for name, result in show(runs.values()).items() if result and not result.current
    ]
    commit = checkout()
    for name in chosen:
        print(f"{name}: {' '.join(runs[name].provenance.command)}", flush=True)
        print(elsewhere(runs[name]), end="", flush=True)
        fly(runs[name], commit)
    if chosen:
        sys.exit(documents.main(["--images"]))


def show(runs: Iterable[Run], foreign: bool = True) -> dict[str, Repeats | None]:
    """Repeat a sample of each run, print what came of it, and keep that beside the run.

    Each environment has a process, beside this one, for all of its runs. `None` stands for a run
    of which the environment is not here, or not used (`foreign`). A sample that code, packages and
    processor have repeated before is not repeated again.
    """
    every = tuple(runs)
    states = {run.name: state(run) for run in every}
    runs = [run for run in every if not states[run.name] or last_state(run) != states[run.name]]
    code = "import sys, blocks, repeats\nfor n in sys.argv[1:]: repeats.write(blocks.load(n))"
    variables = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, sources(ROOT)))}
    own = [run for run in runs if environment(run) == ".venv"]
    others: list[tuple[list[Run], subprocess.Popen[bytes]]] = []
    for place in sorted({environment(run) for run in runs} - {".venv"}):
        if foreign and (python := ROOT / place / "bin" / "python").is_file():
            there = [run for run in runs if environment(run) == place]
            command = (str(python), "-c", code, *(run.name for run in there))
            others.append((there, subprocess.Popen(command, cwd=ROOT, env=variables)))
    results: dict[str, Repeats | None] = {run.name: repeats.write(run) for run in own}
    for there, process in others:
        if process.wait():
            raise subprocess.CalledProcessError(process.returncode, process.args)
        results.update({run.name: run.repeats for run in there})
    for run in every:
        result = results.setdefault(run.name, None if run in runs else run.repeats)
        if result and states[run.name]:
            KEPT.mkdir(parents=True, exist_ok=True)
            (KEPT / run.name).write_text(states[run.name], "utf-8")
        text = str(result) if result else f"not repeated here: it needs {environment(run)}"
        text += f" ({result.first})" if result and result.first else ""
        print(f"{run.name:36s}{run.provenance.wall_s:6.0f} s  {text}", flush=True)
    return results


def state(run: Run) -> str:
    """Return what the repeat of a sample follows from; empty with changes that no commit has."""
    outcomes = (REFERENCE / run.name / OUTCOMES).relative_to(ROOT)
    places = ["src", "quadrotor/src", "examples", "tools", outcomes.as_posix()]
    ask = ("git", "status", "--porcelain", *places)
    if subprocess.run(ask, cwd=ROOT, check=True, capture_output=True).stdout:
        return ""
    names = [f"HEAD:{place}" for place in places]
    trees = subprocess.run(("git", "rev-parse", *names), cwd=ROOT, check=True, capture_output=True)
    installed = (ROOT / environment(run)).glob("lib/*/site-packages/*.dist-info")
    packages = sorted(path.name for path in installed)
    return "\n".join([processor(), environment(run), *packages, trees.stdout.decode()])


def last_state(run: Run) -> str:
    """Return the state by which a run's sample was repeated last."""
    return (KEPT / run.name).read_text("utf-8") if (KEPT / run.name).is_file() else ""


def sources(tree: Path) -> list[Path]:
    """Return the folders of a checkout from which its packages are imported."""
    return [tree / part / "src" for part in (".", "quadrotor", "paper")] + [tree / "tools"]


def by_time() -> dict[str, Run]:
    """Return the reference runs by name, the quickest first."""
    names = {path.parent.name for path in REFERENCE.glob(f"*/{PROVENANCE}")} - {*APART}
    runs = sorted(map(load, names), key=lambda run: run.provenance.wall_s)
    return {run.name: run for run in runs}


def checkout() -> str:
    """Bring the checkout to the last commit, and return that; runs in it stay."""
    if not TREE.is_dir():
        TREE.parent.mkdir(exist_ok=True)
        subprocess.run(("git", "worktree", "prune"), cwd=ROOT, check=True)
        add = ("git", "worktree", "add", "--detach", str(TREE), "HEAD")
        subprocess.run(add, cwd=ROOT, check=True)
    head = subprocess.run(("git", "rev-parse", "HEAD"), cwd=ROOT, check=True, capture_output=True)
    commit = head.stdout.decode().strip()
    subprocess.run(("git", "checkout", "-q", commit), cwd=TREE, check=True)
    for kernels in (ROOT / "quadrotor/src/faultpath_quadrotor/native").glob("kernels-*.so"):
        shutil.copy(kernels, TREE / kernels.relative_to(ROOT).parent)
    return commit


def fly(run: Run, commit: str) -> None:
    """Fly a run again and make it the reference."""
    folder = Path("runs", f"{run.name}-{commit[:12]}")
    command = list(run.provenance.command[1:])
    command[command.index("--out") + 1] = str(folder)
    variables = os.environ | {
        "PYTHONPATH": os.pathsep.join(map(str, sources(TREE))),
        "OMP_NUM_THREADS": "1",
    }
    python = ROOT / environment(run) / "bin" / "python"
    subprocess.run((python, "-m", "faultpath", *command), cwd=TREE, env=variables, check=True)
    documents.take(f"{run.name}={TREE / folder}")
    load.cache_clear()
    show([load(run.name)])


def elsewhere(run: Run) -> str:
    """Return a line for a run of another kind of processor, which rounds differently."""
    before, here = run.provenance.machine.processor, processor()
    if before == here:
        return ""
    return f"It was flown on {before}, and here is {here}: single trials may end differently.\n"


def environment(run: Run) -> str:
    """Return the virtual environment, as make has it, in which a run's system can be built."""
    version = ".".join(run.provenance.machine.python.split(".")[:2])
    if version != f"{sys.version_info.major}.{sys.version_info.minor}":
        return f".venv-{version}"
    example = Path(run.provenance.command[2]).name
    needed = (package for start, package in SYSTEMS.items() if example.startswith(start))
    return ".venv" if all(map(find_spec, needed)) else ".venv-foreign"


if __name__ == "__main__":
    main()
