"""Whole commands: wall time, memory of all their processes, and how soon they answer."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.comparison import Comparison, Outcome, absolute
from benchmarks.results import Record

SCENES = 20
REPEATS = 5
SAMPLE_S = 0.1

STARTS = {
    "faultpath --help": ["--help"],
    "faultpath audit --help": ["audit", "--help"],
    "faultpath interface quadrotor": ["interface", "quadrotor"],
    "faultpath scenes list": ["scenes", "list"],
    "faultpath train quadrotor --list": ["train", "quadrotor", "--list"],
}


@dataclass(frozen=True)
class Run:
    """How long a command took and the most memory that its processes held at a time."""

    seconds: float
    peak_bytes: int


def workers_command(workers: int, out: Path) -> list[str]:
    """Return the main job on a few selection scenes."""
    question = ["--baseline", "gru", "--repair", "gru+dcc", "--fault", "calibration=+0.1"]
    where = ["--library", "selection", "--scenes", str(SCENES), "--wind", "L3"]
    return ["audit", "quadrotor", *question, *where, "--workers", str(workers), "--out", str(out)]


def audit(arguments: Sequence[str]) -> Run:
    """Run a command of faultpath to its end and watch its memory; `RuntimeError` if it fails."""
    with tempfile.TemporaryFile("w+") as said:
        start = time.perf_counter()
        process = subprocess.Popen(
            _command(arguments),
            stdout=said,
            stderr=subprocess.STDOUT,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        peak = 0
        while process.poll() is None:
            peak = max(peak, sum(map(_proportional, _tree(process.pid))))
            time.sleep(SAMPLE_S)
        seconds = time.perf_counter() - start
        if process.returncode:
            said.seek(0)
            raise RuntimeError(f"faultpath {' '.join(arguments)}: {said.read()[-300:]}")
    return Run(seconds, peak)


def starts() -> Outcome:
    """Time what answers at once, from the start of the process to its end."""
    records: list[Record] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in STARTS.items():
            taken = []
            for _ in range(REPEATS + 1):  # the first one fills the file cache
                start = time.perf_counter()
                subprocess.run(
                    _command(arguments), cwd=folder, check=True, stdout=subprocess.DEVNULL
                )
                taken.append(time.perf_counter() - start)
            records.append(absolute("start-up", name, taken[1:], "s"))
    return Outcome(records)


def _command(arguments: Sequence[str]) -> list[str]:
    return [str(Path(sys.executable).with_name("faultpath")), *arguments]


def _tree(root: int) -> list[int]:
    """Return a process and all that descend from it."""
    found, last = [root], [root]
    while last:
        last = [child for parent in last for child in _children(parent)]
        found += last
    return found


def _children(parent: int) -> list[int]:
    try:
        return [
            int(word) for word in Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
        ]
    except OSError:
        return []


def _proportional(process: int) -> int:
    """Return the bytes that a process holds, pages shared by n processes counting a nth each."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return sum(1024 * int(line.split()[1]) for line in lines if line.startswith("Pss:"))


COMPARISONS = (Comparison("start-up", starts),)
