"""What a check or a trace runs, and what it sees of it."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import to_numpy
from faultpath.core.error_source import described
from faultpath.core.errors import UserError
from faultpath.loop import (
    FaultedElsewhere,
    IllegalRead,
    MalformedReading,
    NotDelivered,
    NotFinite,
    Observer,
    Query,
    Reading,
    Tap,
    TapCount,
    UndeclaredReader,
)
from faultpath.trials import Arm, Outcome, System
from faultpath.trials.attempt import Died, Done, Raised, Wrong, attempt
from faultpath.trials.execution.worker import Job, building

MISTAKES: dict[str, tuple[type[Exception], ...]] = {
    "declared reads": (UndeclaredReader, IllegalRead),
    "shape and unit": (MalformedReading, NotFinite),
    "fault delivery": (NotDelivered, FaultedElsewhere),
}
"""What taps refuse, by the check that reports it; all else keeps trials from their end."""
TRIALS = "trials end"


class TraceEnded(BaseException):
    """Enough was seen. No `Exception`: the code of a system may catch those."""


@dataclass(frozen=True)
class Read:
    """What one consumer got of one channel in one control step."""

    step: int
    channel: str
    consumer: str
    source: str
    valid_step: int
    """Step of the reading: before `step` for what is late, held or read of the past."""
    dtype: str = ""
    low: float = math.inf
    high: float = -math.inf
    """Of the finite numbers of all scenes."""
    lost: str = ""
    """A scene with a number that is not finite."""
    asks: int = 0
    """Answers that the consumer got of a query."""
    given: Mapping[str, bytes] = field(default_factory=dict[str, bytes])
    """A digest of what the source held, by scene."""
    got: Mapping[str, bytes] = field(default_factory=dict[str, bytes])
    """A digest of what the consumer got, by scene."""

    @property
    def tap(self) -> tuple[str, str]:
        """Channel and consumer."""
        return self.channel, self.consumer


class Trace(Observer):
    """Notes the reads of the first steps of a run, in the order in which they happened."""

    def __init__(self, scenes: Sequence[str], steps: int | None) -> None:
        self._scenes, self._steps = scenes, steps
        self.held: dict[tuple[int, str, str], Read] = {}

    @override
    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if self._steps is not None and step >= self._steps:
            raise TraceEnded
        key = step, tap.channel, tap.consumer
        if key not in self.held:
            self.held[key] = Read(*key, reading.source, reading.step)
            if not isinstance(reading.value, Query):
                self._note(key, reading.value, got, asks=0)

    @override
    def answered(
        self, tap: Tap, query: Query, step: int, request: Any, answer: Any, got: Any
    ) -> None:
        key = step, tap.channel, tap.consumer
        self._note(key, query.value(answer), query.value(got), asks=1)

    def _note(self, key: tuple[int, str, str], given: Any, got: Any, asks: int) -> None:
        read, values = self.held[key], to_numpy(given)
        numbers, finite = values.astype(np.float64), np.isfinite(values)
        lost = np.flatnonzero(~finite.reshape(len(values), -1).all(axis=1))
        self.held[key] = replace(
            read,
            dtype=str(values.dtype),
            low=float(np.min(numbers, initial=read.low, where=finite)),
            high=float(np.max(numbers, initial=read.high, where=finite)),
            lost=self._scenes[lost[0]] if lost.size else read.lost,
            asks=read.asks + asks,
            given=self._digests(values, read.given),
            got=self._digests(to_numpy(got), read.got),
        )

    def _digests(self, values: Any, before: Mapping[str, bytes]) -> dict[str, bytes]:
        return {
            scene: blake2b(before.get(scene, b"") + row.tobytes(), digest_size=8).digest()
            for scene, row in zip(self._scenes, values, strict=False)
        }


@dataclass(frozen=True)
class Flight:
    """An arm over some scenes, traced."""

    why: str
    arm: Arm
    scenes: tuple[str, ...]
    steps: int | None = None
    """After so many it is stopped; `None`: it runs to its end."""
    tap: tuple[str, str] = ("", "")
    """The only one that a fault reaches."""


@dataclass(frozen=True)
class Flown:
    """What was seen of a flight."""

    outcomes: tuple[Outcome, ...] = ()
    """One a scene; empty where it was stopped or failed."""
    counts: tuple[TapCount, ...] = ()
    reads: tuple[Read, ...] = ()
    error: str = ""
    """What stopped it."""
    blames: str = ""
    """The check that reports the error."""

    def readings(self, dt_s: float) -> dict[tuple[str, int, str, str], bytes]:
        """Return the digest of each reading by scene, step, channel and consumer, while it ran."""
        ends = {o.scene: math.ceil(o.time_s / dt_s) for o in self.outcomes}
        return {
            (scene, read.step, *read.tap): digest
            for read in self.reads
            for scene, digest in read.given.items()
            if read.step < ends.get(scene, read.step + 1)
        }


def fly(job: Job, flight: Flight) -> Flown:
    """Run in a worker process."""
    with building(job) as built:
        return fly_here(built.system, flight)


def fly_here(system: System, flight: Flight) -> Flown:
    """Run with a system that is built, in blocks of its size; an error ends it."""
    outcomes, counts, reads = list[Outcome](), list[TapCount](), list[Read]()
    error = blames = ""
    for first in range(0, len(flight.scenes), system.block_size):
        scenes = flight.scenes[first : first + system.block_size]
        trace, found = Trace(scenes, flight.steps), None
        with suppress(TraceEnded):
            found = attempt(system, flight.arm, scenes, observer=trace)
        reads += trace.held.values()
        if isinstance(found, Done):
            outcomes += found.outcomes
            counts += found.taps
            if lost := next((o for o in found.outcomes if o.failed), None):
                error, blames = f"{lost.error} in scene {lost.scene!r}", TRIALS
        elif isinstance(found, Raised):
            kind, _, text = found.error.partition(": ")
            error, blames = found.error, TRIALS
            if kind == NotFinite.__name__:
                error, blames = text, "shape and unit"
        elif isinstance(found, Wrong):
            error = str(found.error)
            blamed = (name for name, kinds in MISTAKES.items() if isinstance(found.error, kinds))
            blames = next(blamed, TRIALS)
        if error:
            return Flown((), tuple(counts), tuple(reads), error, blames)
    return Flown(tuple(outcomes), tuple(counts), tuple(reads))


def lost(reply: Died | Wrong) -> Flown:
    """Return what is known of a flight whose worker gave nothing back; raises a `UserError`."""
    if isinstance(reply, Wrong) and isinstance(reply.error, UserError):
        raise reply.error
    error = described(reply.error) if isinstance(reply, Wrong) else reply.how
    return Flown(error=error, blames=TRIALS)
