"""Side by side: rounds in which every side does a little work, one after the other, on one core."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import IO, Any, Literal, Self

from benchmarks.results import ROOT
from faultpath.quadrotor.native import library
from faultpath.work.processes import KEEP_MEMORY

ROUNDS = 9
ROUND_S = 0.25
"""Seconds that one side works in one round: long against a time slice, short against a drift."""

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
    "JAX_PLATFORMS": "cpu",
}
Clock = Literal["processor", "wall"]


class NotMeasured(Exception):
    """A side that could not be built, or that gives other numbers than its counterpart."""


@dataclass
class Side:
    """Work that is timed; a function of the side's module builds it in the child process."""

    work: Callable[[], object]
    amount: float = 1.0
    """Units of work in one repetition; a rate is amount times repetitions over seconds."""
    answer: Callable[[], Sequence[float]] = list
    """Numbers that another side must reproduce; empty where nothing is comparable."""
    prepare: Callable[[], object] = lambda: None
    """Gets ready for the next repetition; this is not timed."""


@dataclass(frozen=True)
class Work:
    """How to build a side: what builds it as `module:name`, arguments and environment."""

    side: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)


def portable(side: str, **arguments: Any) -> Work:
    """Return a side that runs without compiled kernels."""
    return Work(side, arguments, {library.VARIABLE: library.PORTABLE})


def processors() -> list[int]:
    """Return the processors, that on which sides run first: the last serves no interrupts."""
    return sorted(os.sched_getaffinity(0), reverse=True)


def _kernels() -> Mapping[str, str]:
    """Name the kernels that the sides run: one that cannot load them says so, and does not go on
    with the portable path."""
    found = library.kernels()
    return {library.VARIABLE: library.PORTABLE if found is None else found.isa}


class Running:
    """A side in its process; a context that ends it."""

    def __init__(self, work: Work, cpu: int | None = None) -> None:
        """Start the process; `NotMeasured` where the side cannot be built."""
        where = str(processors()[0] if cpu is None else cpu)
        command = [sys.executable, "-m", "benchmarks.child", work.side]
        self._log: IO[str] = tempfile.TemporaryFile("w+")  # noqa: SIM115, closed by __exit__
        self._process = subprocess.Popen(
            [*command, json.dumps(dict(work.arguments)), where],
            cwd=ROOT,
            env={**os.environ, **KEEP_MEMORY, **ONE_THREAD, **_kernels(), **work.environment},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
        )
        try:
            self.amount: float = self._reply()["amount"]
            self._each = max(min(self.seconds(3)), 1e-6)
        except NotMeasured:
            self.__exit__()
            raise

    def seconds(self, repeats: int, clock: Clock = "processor") -> list[float]:
        """Return how long each of some repetitions takes, s."""
        return self._ask(do="time", repeats=repeats, clock=clock)["seconds"]

    def rate(self, round_s: float = ROUND_S, clock: Clock = "processor") -> float:
        """Return units of work a second over one round."""
        repeats = max(1, round(round_s / self._each))
        return self.amount * repeats / sum(self.seconds(repeats, clock))

    def answer(self) -> list[float]:
        """Return the numbers that the side works out."""
        return self._ask(do="answer")["answer"]

    def _ask(self, **request: Any) -> dict[str, Any]:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return self._reply()

    def _reply(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            self._log.seek(0)
            last = self._log.read().strip().splitlines()[-1:] or ["no message"]
            raise NotMeasured(f"the process ended: {last[0]}")
        reply = json.loads(line)
        if "error" in reply:
            raise NotMeasured(reply["error"])
        return reply

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        try:
            self._process.communicate(timeout=10)  # closes its input, which ends it
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()
        self._log.close()


@dataclass(frozen=True)
class Rates:
    """Units of work a second, round by round, and why some sides have none."""

    rounds: Mapping[str, Sequence[float]]
    missing: Mapping[str, str]


def interleaved(
    works: Mapping[str, Work],
    rounds: int,
    same: Mapping[str, str] | None = None,
    tolerance: float = 1e-3,
) -> Rates:
    """Let the sides take turns, `rounds` times, and return their rates.

    `same` says which side must give the numbers of which other, within `tolerance`: one that does
    not is left out, as is one that cannot be built, and the others go on.
    """
    missing: dict[str, str] = {}
    with ExitStack() as stack:
        sides: dict[str, Running] = {}
        for name, work in works.items():
            try:
                sides[name] = stack.enter_context(Running(work))
            except NotMeasured as reason:
                missing[name] = str(reason)
        for name, other in (same or {}).items():
            if name in sides and other in sides:
                apart = _distance(sides[name].answer(), sides[other].answer())
                if not apart <= tolerance:
                    missing[name] = f"its numbers differ from those of {other} by {apart:.3g}"
                    del sides[name]
        found: dict[str, list[float]] = {name: [] for name in sides}
        for _ in range(rounds):
            for name, side in sides.items():
                found[name].append(side.rate())
    return Rates(found, missing)


def _distance(one: Sequence[float], other: Sequence[float]) -> float:
    if len(one) != len(other) or not one:
        return float("inf")
    return max(abs(a - b) for a, b in zip(one, other, strict=True))
