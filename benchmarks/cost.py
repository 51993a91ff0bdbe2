"""Time and memory of whole audits, beside the trials themselves; it shows them and keeps nothing.

python -m benchmarks.cost arm [--rounds N]      an audit of a two-link arm, and the same trials in a
                                                bare loop
python -m benchmarks.cost toy [--scenes N ...]  commands that audit the toy in so many scenes
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import faultpath
from benchmarks import two_link
from benchmarks.results import ROOT
from benchmarks.side import check_same
from faultpath.core.files.parquet import read_table

_SCENES, _FACTOR = 20, 0.5
_ARMS = (
    (1.0, 1.0),
    (1.0, _FACTOR),
    (_FACTOR, 1.0),
    (_FACTOR, _FACTOR),
    (None, 1.0),
    (None, _FACTOR),
)
"""Payload of observer and controller in each arm of the audit; see `two_link.bare`."""
_LIBRARY = 'tuple(SceneRef(f"cart/{i:03d}", i) for i in range(100))'


def _bare() -> list[list[float]]:
    scenes = [scene.id for scene in two_link.create().library("held-out").scenes[:_SCENES]]
    return [[two_link.bare(scene, *payloads) for scene in scenes] for payloads in _ARMS]


def _audited() -> list[list[float]]:
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "run"
        faultpath.audit(
            ROOT / "benchmarks" / "two_link.py",
            baseline="calibrated",
            repair="nominal",
            fault=f"payload:scale={_FACTOR}",
            scenes=_SCENES,
            workers=0,
            folder=place,
            progress=False,
        )
        missed: Any = read_table((place / "outcomes.parquet").read_bytes()).column("missed_rad")
    return missed.to_numpy().reshape(-1, _SCENES).tolist()


def _timed(work: Callable[[], list[list[float]]]) -> tuple[float, list[list[float]]]:
    began = time.perf_counter()
    numbers = work()
    return time.perf_counter() - began, numbers


def arm(rounds: int) -> None:
    """Print the time of an audit in this process as a multiple of its bare trials."""
    ratios: list[float] = []
    for number in range(1, rounds + 1):
        bare_s, alone = _timed(_bare)
        audit_s, audited = _timed(_audited)
        ours = sorted(set(map(tuple, np.round(audited, 9).tolist())))
        check_same(sorted(map(tuple, np.round(alone, 9).tolist())), ours, 1e-6)
        ratios.append(audit_s / bare_s)
        print(f"round {number}: audit {audit_s:.2f} s, bare loop {bare_s:.2f} s", flush=True)
    print(f"An audit takes {statistics.median(ratios):.2f} times its trials in a bare loop.")


def toy(scenes: int) -> None:
    """Print time, memory and size of a command that audits the toy in so many scenes."""
    text = (ROOT / "examples" / "toy.py").read_text("utf-8")
    if _LIBRARY not in text:
        sys.exit("examples/toy.py makes its library otherwise: correct benchmarks/cost.py")
    with tempfile.TemporaryDirectory() as folder:
        system, run = Path(folder) / "toy.py", Path(folder) / "run"
        system.write_text(text.replace(_LIBRARY, _LIBRARY.replace("100", str(scenes))), "utf-8")
        command = [sys.executable, "-m", "faultpath", "audit", f"{system}:create"]
        command += ["--baseline", "calibrated", "--repair", "blind", "--library", "carts"]
        command += ["--fault", "gain:scale=0.6", "--workers", "2", "--out", str(run)]
        began = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        taken = time.perf_counter() - began
        if status:
            sys.exit(f"the audit ended with {os.waitstatus_to_exitcode(status)}")
        files = [file for file in run.rglob("*") if file.is_file()]
        size = sum(file.stat().st_size for file in files) / 2**20
        report = (run / "report.html").stat().st_size / 2**20
    print(
        f"toy, {scenes} scenes: {taken:.0f} s, {usage.ru_maxrss / 2**20:.2f} GB, report "
        f"{report:.0f} MB, folder {size:.0f} MB",
        flush=True,
    )


def main() -> None:
    """Measure what the command line names."""
    parser = argparse.ArgumentParser(
        prog="benchmarks.cost", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("what", choices=("arm", "toy"))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--scenes", type=int, nargs="+", default=[1000, 10_000])
    options = parser.parse_args()
    if options.what == "arm":
        arm(options.rounds)
    else:
        for scenes in options.scenes:
            toy(scenes)


if __name__ == "__main__":
    main()
