"""Readings and queries that pass a tap, and the errors that a tap raises."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from faultpath.core.arrays import Array
from faultpath.core.errors import SystemMistake


@dataclass(frozen=True, slots=True)
class Reading:
    """Value of a source. A reader cannot write to it; its owner may once the step is over."""

    value: Array
    """`[B, ...]`, one row a scene, in the source's unit; or a `Query` with such answers."""
    source: str
    step: int
    """Control step at which the value was valid."""


@dataclass(frozen=True, slots=True)
class Query:
    """Value of a reading that is a function: clearance at points, motion under commands.

    A tap delivers it as a function of one argument. Every answer passes the tap: faults act on it,
    and the delivery log counts it. The n-th request of a step has random numbers and a memory of
    its own, so an intervention that holds or delays gives it what the n-th request of an earlier
    step got.
    """

    answer: Callable[[Any], Any]
    """Returns the answer to a request without a fault."""
    value: Callable[[Any], Array] = lambda answer: answer
    """Returns the array `[B, ...]` in an answer that faults act on, as the source declares it; only
    called where that array is needed."""
    changed: Callable[[Any, Array], Any] = lambda answer, value: value
    """Returns the answer with another array in the place of that one."""


class TapError(SystemMistake):
    """A tap was used in a way the interface does not allow; the sentence names the tap."""


class UndeclaredReader(TapError):
    """A reader asked for a channel that it is not declared to read in this variant."""


class IllegalRead(TapError):
    """A reading came from another source, from a privileged one, or from the future."""


class MalformedReading(TapError):
    """A reading is not what its source declares, or steps ran backwards."""


class NotFinite(Exception):
    """The first reading at a tap is not finite.

    Fails the trial, not the run, because a fault further up may have caused it.
    """


class WrittenTo(TapError):
    """A reader wrote into a delivered array, which other readers may share."""


class NotDelivered(TapError):
    """A fault never reached a reader that it names, although a scene ran past its onset."""


class FaultedElsewhere(TapError):
    """A reader got an altered reading although no fault names it."""
