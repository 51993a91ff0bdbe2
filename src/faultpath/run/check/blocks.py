"""Blocks of scenes that a check, a trace or a replay runs and records, and what came of them."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from faultpath.core.error_source import described, location_in
from faultpath.core.errors import UserError
from faultpath.loop import (
    FaultedElsewhere,
    IllegalRead,
    MalformedReading,
    NotDelivered,
    NotFinite,
    TapCount,
    UndeclaredReader,
    added,
    check_reached,
)
from faultpath.run.attempt import Done, Raised, attempt
from faultpath.run.check.reads import Enough, Read, ReadLog
from faultpath.run.check.recording import Recording, signals, with_plant
from faultpath.run.check.results import Delivery, Difference
from faultpath.run.execution.dispatch import Built, UndeclaredFile, dispatch
from faultpath.run.execution.recheck import deviation
from faultpath.run.pairing import unlike
from faultpath.run.plan import Treatment
from faultpath.run.store.signals import Signal
from faultpath.run.work.executor import Executor, Failed, Lost
from faultpath.system.declared import Variant
from faultpath.system.outcome import Outcome
from faultpath.system.system import System

_MISTAKES: dict[str, tuple[type[Exception], ...]] = {
    "declared reads": (UndeclaredReader, IllegalRead),
    "shape and unit": (MalformedReading, NotFinite),
    "fault delivery": (NotDelivered, FaultedElsewhere),
    "data files": (UndeclaredFile,),
}
"""Errors by the check that reports them; any other error keeps trials from their end."""
_BFLOAT16 = 2.0**-7
"""Relative spacing of a kind of number that NumPy does not have."""
TRIALS = "trials end"
UNDER = "under the fault: "
"""Begins why a variant was run under the user's fault; its condition follows."""


@dataclass(frozen=True)
class BlockSpec:
    """A treatment over some scenes."""

    treatment: Treatment
    scenes: tuple[str, ...]
    why: str = ""
    steps: int | None = None
    """After so many it is stopped; `None`: it runs to its end."""
    tap: tuple[str, str] = ("", "")
    """The one that is looked at, where it is one."""
    signals: bool = False
    """Whether signals are wanted, and not reads."""
    second: bool = False
    """Whether it is the second of two runs in a row in one process, of which the first is lost."""


@dataclass(frozen=True)
class RecordedBlock:
    """The result of a block."""

    outcomes: tuple[Outcome, ...] = ()
    """One a scene; fewer where it was stopped or an error ended it."""
    counts: tuple[TapCount, ...] = ()
    reads: tuple[Read, ...] = ()
    signals: tuple[tuple[Signal, ...], ...] = ()
    """Signals of each scene."""
    error: str = ""
    """Error that stopped it, or kept a scene from its end."""
    fails: str = ""
    """The check that reports the error."""

    dt_s: float = 0.0
    """Seconds of a control step."""

    @cached_property
    def clean(self) -> Mapping[Delivery, bytes]:
        """Digest of what the source held, of each reading while its scene ran."""
        return self._by_delivery("clean")

    @cached_property
    def got(self) -> Mapping[Delivery, bytes]:
        """Digest of what the reader got."""
        return self._by_delivery("got")

    @cached_property
    def sums(self) -> Mapping[Delivery, float]:
        """Sum of the finite numbers that the source held."""
        return self._by_delivery("sums")

    def _by_delivery(self, what: str) -> dict[Delivery, Any]:
        ends = {outcome.scene: outcome.steps(self.dt_s) for outcome in self.outcomes}
        return {
            (scene, read.step, *read.tap): noted
            for read in self.reads
            for scene, noted in zip(read.scenes, getattr(read, what), strict=False)
            if read.step < ends.get(scene, read.step + 1)
        }


def run_blocks(
    executor: Executor,
    built: Built,
    blocks: Iterable[BlockSpec],
    handle_reply: Callable[[BlockSpec, RecordedBlock], None],
) -> None:
    """Run blocks on the workers of an executor; `handle_reply` gets each result.

    Raises a `UserError` that ended a worker.
    """
    waiting = iter(blocks)

    def handle(block: BlockSpec, reply: RecordedBlock | Lost | Failed) -> None:
        if isinstance(reply, Lost):
            reply = RecordedBlock(error=reply.how, fails=TRIALS)
        elif isinstance(reply, Failed):
            error = reply.error
            if isinstance(error, UndeclaredFile):
                reply = RecordedBlock(error=str(error), fails="data files")
            elif isinstance(error, UserError):
                raise error
            else:
                reply = RecordedBlock(error=described(error), fails=TRIALS)
        handle_reply(block, reply)

    dispatch(executor, built, run_block, lambda _: next(waiting, None), handle)


def run_block(system: System, block: BlockSpec) -> RecordedBlock:
    """Run in blocks of the system's size; an error ends it."""
    if block.second:
        run_block(system, replace(block, second=False))
    outcomes, counts, reads = list[Outcome](), list[TapCount](), list[Read]()
    signals_by_scene = list[tuple[Signal, ...]]()
    error = fails = ""
    size = system.scenes_a_block(len(block.scenes))
    for first in range(0, len(block.scenes), size):
        scenes = block.scenes[first : first + size]
        recording, log, result = Recording(), ReadLog(scenes, block.steps), None
        if block.signals:
            result = attempt(
                with_plant(system, recording), block.treatment, scenes, observer=recording
            )
        else:
            with suppress(Enough):
                result = attempt(system, block.treatment, scenes, observer=log)
        reads += log.reads()
        if isinstance(result, Done):
            outcomes += result.outcomes
            counts += result.taps
            if block.signals:
                signals_by_scene += signals(system, recording, result)
            elif lost := next((o for o in result.outcomes if o.failed), None):
                error, fails = f"{lost.error} in scene {lost.scene!r}", TRIALS
        elif isinstance(result, Raised):
            kind, _, text = result.error.partition(": ")
            at = location_in(result.traceback)
            error, fails = f"{result.error} ({at})" if at else result.error, TRIALS
            for scene in scenes if block.tap == ("", "") else ():
                if not scenes[1:] or isinstance(attempt(system, block.treatment, (scene,)), Raised):
                    error += f" in scene {scene!r}"
                    break
            if kind == NotFinite.__name__:
                error, fails = text, "shape and unit"
        elif isinstance(result, Failed):
            error = str(result.error)
            failing = (name for name, kinds in _MISTAKES.items() if isinstance(result.error, kinds))
            fails = next(failing, TRIALS)
        if error:
            break
    if not error and not block.signals:  # those are recorded in a few scenes of a treatment
        try:
            check_reached(added(counts), [o.steps(system.control_dt_s) - 1 for o in outcomes])
        except NotDelivered as missed:
            error, fails = str(missed), "fault delivery"
    return RecordedBlock(
        outcomes=() if error else tuple(outcomes),
        counts=tuple(counts),
        reads=tuple(reads),
        signals=tuple(signals_by_scene),
        error=error,
        fails=fails,
        dt_s=system.control_dt_s,
    )


def coarsest(run: RecordedBlock) -> float:
    """Return the relative spacing of the coarsest numbers that were read."""
    kinds = {read.dtype for read in run.reads if "float" in read.dtype}
    return max(
        (_BFLOAT16 if k == "bfloat16" else float(np.finfo(k).eps) for k in kinds), default=0.0
    )


def gap_of(first: RecordedBlock, again: RecordedBlock) -> float:
    """Return by how much of their size metrics and sums of readings differ at most; infinity for
    other ends. Nothing that ran differs from nothing."""
    by_scene = {outcome.scene: outcome for outcome in first.outcomes}
    for two in again.outcomes:
        one = by_scene[two.scene]
        if (one.status, one.time_s) != (two.status, two.time_s) or unlike(one, two):
            return math.inf

    def numbers(run: RecordedBlock) -> dict[tuple[Any, ...], float]:
        sums = {
            ((channel, at), scene, step): value
            for (scene, step, channel, at), value in run.sums.items()
        }
        metrics = ((outcome.scene, outcome.metrics.items()) for outcome in run.outcomes)
        return sums | {(name, scene): v or 0.0 for scene, named in metrics for name, v in named}

    then, sizes = numbers(first), dict[Any, float]()
    for (what, *_), value in then.items():
        sizes[what] = max(sizes.get(what, 0.0), abs(value))
    gaps = (
        abs(value - then.get(key, math.inf)) / (sizes.get(key[0]) or 1.0)
        for key, value in numbers(again).items()
    )
    return max(gaps, default=0.0)


@dataclass
class CheckRuns:
    """The runs of a check."""

    system: System
    variants: tuple[Variant, ...]
    scenes: tuple[str, ...]
    seed: int
    apart: bool
    """Whether runs were repeated in processes of their own."""
    recorded: dict[tuple[str, str, tuple[str, str]], RecordedBlock] = field(
        default_factory=dict[tuple[str, str, tuple[str, str]], RecordedBlock]
    )
    """By variant, why it was run, and the tap that was faulted alone."""

    def get(self, variant: str, why: str, tap: tuple[str, str] = ("", "")) -> RecordedBlock:
        """Return what was recorded of a run; nothing where there was none."""
        return self.recorded.get((variant, why, tap), RecordedBlock())

    def firsts(self) -> Iterator[tuple[str, RecordedBlock]]:
        """Yield the first run, under correct inputs, of each variant that came to its end."""
        for variant in self.variants:
            run = self.get(variant.name, "first")
            if run.outcomes:
                yield variant.name, run

    def under(self) -> Iterator[tuple[str, str, RecordedBlock]]:
        """Yield the runs under the user's fault, each with its variant and condition."""
        for (variant, why, _), run in self.recorded.items():
            if why.startswith(UNDER):
                yield variant, condition_of(why), run

    def unsteady(self) -> list[str]:
        """Return the variants of which a second run differs from the first."""
        return [variant for variant, _ in self.firsts() if self.difference(variant, "again")]

    def difference(self, variant: str, why: str, base: str = "first") -> Difference | None:
        """Return how a run of a variant differs from its first one; `None` where it does not."""
        first, again = self.get(variant, base), self.get(variant, why)
        if error := again.error or first.error:
            return Difference(error=error)
        if not again.outcomes:
            return None
        odd = [key for key, digest in again.clean.items() if first.clean.get(key) != digest]
        by_scene = {outcome.scene: outcome for outcome in first.outcomes}
        before = [by_scene[outcome.scene] for outcome in again.outcomes]
        outcomes = deviation(before, Done(again.outcomes, ()))
        if outcomes is None and not odd:
            return None
        reading = min(odd, key=lambda key: key[1], default=None)
        return Difference(outcomes=outcomes, reading=reading)


def condition_of(why: str) -> str:
    """Return the condition of the user's fault under which a variant was run; empty without it."""
    return why.removeprefix(UNDER) if why.startswith(UNDER) else ""
