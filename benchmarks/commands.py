"""Whole commands: wall time, memory of all their processes, and how soon they answer."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from benchmarks.comparison import Case, Effort
from benchmarks.measure import Running, Work, processors
from benchmarks.results import Record, at_least, at_most, record

SCENES = 20
REPEATS = 5
SAMPLE_S = 0.1
PRODUCT_S = 4.0

STARTS = (
    "--help",
    "audit --help",
    "interface quadrotor",
    "scenes list",
    "train quadrotor --list",
)
MAIN_JOB = (
    "audit quadrotor --baseline gru --repair gru+dcc --fault calibration=+0.1 --wind L3 "
    "--library selection"
)


def _command(*arguments: str) -> list[str]:
    return [str(Path(sys.executable).with_name("faultpath")), *arguments]


def _environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def _start(words: str, effort: Effort) -> Iterator[Record]:
    """Time what answers at once, from the start of the process to its end."""
    taken = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(effort.of(REPEATS) + 1):  # the first one leaves byte code and a full cache
            start = time.perf_counter()
            command = _command(*words.split())
            subprocess.run(
                command, cwd=folder, check=True, stdout=subprocess.DEVNULL, env=_environment()
            )
            taken.append(time.perf_counter() - start)
    yield record(f"faultpath {words}", "s", taken[1:])


def _workers(effort: Effort) -> Iterator[Record]:
    """Run a small audit with one worker and with two, and watch its memory."""
    scenes = ["--scenes", str(effort.of(SCENES))]
    with tempfile.TemporaryDirectory() as folder:
        audit = (*MAIN_JOB.split(), "--workers")
        _watched(*audit, "1", "--scenes", "1", "--out", f"{folder}/first")  # leaves byte code
        (one, _), (two, peak) = (
            _watched(*audit, n, *scenes, "--out", f"{folder}/{n}") for n in ("1", "2")
        )
    yield record(
        "Small audit, two workers against one",
        "s",
        *([two], [one], [one / two]),
        ours_name="two workers",
        peer_name="one worker",
        target=at_least(1.8),
        note="Start-up and the report are in both.",
    )
    yield record(
        "Small audit, two workers: peak memory",
        "GB",
        [peak / 1e9],
        target=at_most(2.0, "ours"),
        note="All processes together; what they share counts once.",
    )


def _watched(*arguments: str) -> tuple[float, int]:
    """Return how long a command took, s, and the most bytes that its processes held at a time.

    Raises `RuntimeError` if it fails.
    """
    with tempfile.TemporaryFile("w+") as said:
        start = time.perf_counter()
        process = subprocess.Popen(
            _command(*arguments),
            stdout=said,
            stderr=subprocess.STDOUT,
            env={**_environment(), "OMP_NUM_THREADS": "1"},
        )
        peak = 0
        while process.poll() is None:
            peak = max(peak, sum(map(_proportional, _tree(process.pid))))
            time.sleep(SAMPLE_S)
        seconds = time.perf_counter() - start
        if process.returncode:
            said.seek(0)
            raise RuntimeError(f"faultpath {' '.join(arguments)}: {said.read()[-300:]}")
    return seconds, peak


def _tree(root: int) -> Iterator[int]:
    yield root
    for child in _lines(f"/proc/{root}/task/{root}/children"):
        for each in child.split():
            yield from _tree(int(each))


def _proportional(process: int) -> int:
    lines = _lines(f"/proc/{process}/smaps_rollup")
    return sum(1024 * int(line.split()[1]) for line in lines if line.startswith("Pss:"))


def _lines(path: str) -> Sequence[str]:
    try:
        return Path(path).read_text().splitlines()
    except OSError:  # the process has ended
        return ()


def _ceiling(effort: Effort) -> Iterator[Record]:
    product, cpus = Work("benchmarks.planning:matrix_product"), processors()
    length = max(0.1, effort.share * PRODUCT_S)

    def rate(side: Running) -> float:
        return side.rate(length, "wall") / side.amount

    with (
        Running(product, cpus[0]) as one,
        Running(product, cpus[-1]) as other,
        ThreadPoolExecutor(2) as both,
    ):
        rounds = [(rate(one), sum(both.map(rate, (one, other)))) for _ in range(effort.of(3))]
    alone, together = zip(*rounds, strict=True)
    yield record(
        "torch.mm alone, two processes against one",
        "products/s",
        *(together, alone, [two / one for one, two in rounds]),
        ours_name="two processes",
        peer_name="one process",
        note="What this machine gives a second process that multiplies matrices and nothing else.",
    )


START_UP: Mapping[str, Case] = {f"faultpath {words}": partial(_start, words) for words in STARTS}
WORKERS: Mapping[str, Case] = {
    "Small audit, two workers against one": _workers,
    "torch.mm alone, two processes against one": _ceiling,
}
