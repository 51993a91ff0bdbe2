"""Time every step that a user waits for, from a clone to reports; `waits.json` keeps the figures.

python -m benchmarks.waits           clone the last commit, take each step once, some minutes
python -m benchmarks.waits --tests   the tests alone, in a clone of their own

A step is timed by the clock on the wall, set-up and imports included. Packages come from wherever
pip is told to find them, so the times of the two set-ups depend on the network.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.results import ROOT, WAITS
from faultpath.run.provenance import processor

_VARIANTS = "--baseline calibrated --repair typical"
AUDIT = f"faultpath audit mine.py:create {_VARIANTS} --fault gain:scale=0.6 --out runs/mine"
STEPS = {
    "pip install .": "engine and command, into an empty environment",
    "faultpath demo": "the cart's audit and its report",
    "faultpath init mine": "a system to start from",
    "faultpath check mine.py:create": "its check",
    AUDIT: "its audit and report",
    "faultpath report runs/mine": "the report once more",
    'make audit ARGS="--scenes 4"': "set-up with torch, then 4 scenes of the quadrotor",
    "make audit": "the main audit, 100 scenes, and its report",
}
"""Commands in the order in which a user gives them, and what each does."""
TESTS = {"make test": "set-up for development, and all tests"}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.waits")
    parser.add_argument("--tests", action="store_true", help="run the tests alone")
    tests = parser.parse_args().tests
    kept = json.loads(WAITS.read_text()) if WAITS.is_file() else {}
    with TemporaryDirectory() as folder:
        kept["tests" if tests else "steps"] = taken(
            Path(folder, "clone"), TESTS if tests else STEPS
        )
    WAITS.write_text(json.dumps(kept, indent=1) + "\n")


def taken(clone: Path, steps: dict[str, str]) -> dict[str, object]:
    """Return machine and commit, and the seconds of each step in a fresh clone."""
    subprocess.run(("git", "clone", "-q", str(ROOT), str(clone)), check=True)
    head = subprocess.run(("git", "rev-parse", "HEAD"), cwd=clone, check=True, capture_output=True)
    venv = clone / "build" / "user"
    python = getattr(sys, "_base_executable", sys.executable)
    subprocess.run((python, "-m", "venv", str(venv)), check=True)
    path = os.pathsep.join((str(venv / "bin"), os.environ["PATH"]))
    variables = {name: text for name, text in os.environ.items() if name != "PYTHONPATH"}
    seconds = {}
    for step in steps:
        begun = time.perf_counter()
        subprocess.run(step, shell=True, cwd=clone, env=variables | {"PATH": path}, check=True)
        seconds[step] = round(time.perf_counter() - begun, 1)
        print(f"{step}: {seconds[step]} s", flush=True)
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "processor": processor(),
        "cores": len(os.sched_getaffinity(0)),
        "commit": head.stdout.decode().strip(),
        "seconds": seconds,
    }


if __name__ == "__main__":
    main()
