"""What a check flies, and what it sees of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

from faultpath.blame import described
from faultpath.errors import UserError
from faultpath.execution.attempt import Died, Done, Raised, Wrong, attempt
from faultpath.execution.worker import Brief, building
from faultpath.faults import Fault, Offset, Replace, Scale
from faultpath.faults import Sequence as InTurn
from faultpath.taps import (
    IllegalRead,
    MalformedReading,
    NotDelivered,
    NotFinite,
    Read,
    StruckElsewhere,
    TapCount,
    Trace,
    TracedTaps,
    TraceEnded,
    UndeclaredReader,
)
from faultpath.trials import Arm, Outcome, System

MISTAKES: dict[str, tuple[type[Exception], ...]] = {
    "reads": (UndeclaredReader, IllegalRead),
    "readings": (MalformedReading, NotFinite),
    "delivery": (NotDelivered, StruckElsewhere),
}
"""What taps refuse, by the check that tells of it."""


@dataclass(frozen=True)
class Flight:
    """An arm over some scenes, traced."""

    why: str
    arm: Arm
    scenes: tuple[str, ...]
    steps: int | None = None
    """After so many it is stopped; `None`: it flies to its end."""

    @property
    def variant(self) -> str:
        """Name of the variant."""
        return self.arm.variant


@dataclass(frozen=True)
class Flown:
    """What was seen of a flight."""

    outcomes: tuple[Outcome, ...] = ()
    """One a scene; empty where it was stopped or failed."""
    counts: tuple[TapCount, ...] = ()
    reads: tuple[Read, ...] = ()
    refused: Mapping[tuple[str, str], str] = field(default_factory=dict[tuple[str, str], str])
    """See `Trace.refused`."""
    truths: frozenset[tuple[str, str]] = frozenset()
    """See `Trace.truths`."""
    error: str = ""
    """What stopped it."""
    blames: str = ""
    """The check that tells of the error."""


def fly(brief: Brief, flight: Flight) -> Flown:
    """Fly in a worker process."""
    with building(brief) as built:
        return fly_here(built.system, flight)


def fly_here(system: System, flight: Flight) -> Flown:
    """Fly with a system that is built."""
    trace = Trace(steps=flight.steps)
    found = None
    try:
        taps = partial(TracedTaps, trace=trace)
        found = attempt(system, flight.arm, flight.scenes, kind=taps)
    except TraceEnded:
        pass
    refused = trace.refused
    if isinstance(found, Done):
        lost = next((o for o in found.outcomes if o.failed), None)
        error = f"{lost.error} in scene {lost.scene!r}" if lost else ""
        blames = "trials" if lost else ""
        outcomes, counts = found.outcomes, found.taps
    else:
        outcomes, counts = (), ()
        error, blames = ("", "") if found is None else _said(found)
    truths = frozenset(trace.truths)
    return Flown(outcomes, counts, trace.reads, refused, truths, error, blames)


def _said(found: Raised | Wrong) -> tuple[str, str]:
    if isinstance(found, Raised):
        kind, _, text = found.error.partition(": ")
        return (text, "readings") if kind == NotFinite.__name__ else (found.error, "trials")
    error = found.error
    blames = next((k for k, kinds in MISTAKES.items() if isinstance(error, kinds)), "trials")
    return str(error), blames


def unflown(reply: Died | Wrong) -> Flown:
    """Return what is known of a flight whose worker gave nothing back; raises a `UserError`."""
    if isinstance(reply, Wrong):
        if isinstance(reply.error, UserError):
            raise reply.error
        return Flown(error=described(reply.error), blames="trials")
    return Flown(error=reply.how, blames="trials")


def probe(read: Read) -> Fault:
    """Return a fault that alters whatever a tap delivers, struck alone."""
    if "float" in read.dtype:
        doing = InTurn(parts=(Scale(factor=1.5), Offset(by=0.25)))
    else:  # that keeps whole numbers and truths what they are
        other = 1.0 - read.low if read.dtype == "bool" else read.high + 1.0
        doing = Replace(value=other)
    return Fault(channel=read.channel, intervention=doing, consumers=(read.consumer,))
