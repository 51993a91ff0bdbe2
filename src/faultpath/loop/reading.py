"""Readings and queries that pass a tap, and the errors that a tap raises."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from faultpath.core.arrays import Array
from faultpath.core.errors import SystemMistake


@dataclass(frozen=True, slots=True)
class Reading:
    """A source's value. A reader cannot write to it; its owner may once the step is over."""

    value: Array
    """`[B, ...]`, one row a scene, in the source's unit; or a `Query` whose answers are."""
    source: str
    step: int
    """Control step at which the value was valid."""


@dataclass(frozen=True, slots=True)
class Query:
    """The value of a reading that is a function: clearance at points, motion under commands.

    A tap delivers it as a function of one argument whose every answer passes the tap: faults act
    on each, and receipts count them. The n-th ask of a step has random numbers and a memory of its
    own, so an intervention that holds or delays gives the n-th ask what the n-th ask got before.
    """

    answer: Callable[[Any], Any]
    """Returns what a request gets without a fault."""
    value: Callable[[Any], Array] = lambda answer: answer
    """The array `[B, ...]` in an answer that faults act on, as the source declares it. It is
    called only where something looks at it."""
    changed: Callable[[Any, Array], Any] = lambda answer, value: value
    """The answer with another such array in its place."""


class TapError(SystemMistake):
    """A tap was used against what the interface declares; the sentence names the tap."""


class UndeclaredReader(TapError):
    """A reader asked for a channel that it is not declared to read in this variant."""


class IllegalRead(TapError):
    """A reading came from another source, from a privileged one, or from the future."""


class MalformedReading(TapError):
    """A reading is not what its source declares, or steps ran backwards."""


class NotFinite(Exception):
    """The first reading at a tap is not finite. Fails the trial, not the run, because a
    fault further up may have brought it about."""


class WrittenTo(TapError):
    """A reader wrote into what a tap gave it, and others may have read that."""


class NotDelivered(TapError):
    """A fault never reached a reader that it names, although a scene ran past its onset."""


class FaultedElsewhere(TapError):
    """A reader that no fault names got an altered reading."""
