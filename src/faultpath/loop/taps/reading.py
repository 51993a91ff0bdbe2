"""A source's value at a step, and a source that its consumer asks as often as it wants."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from faultpath.core.arrays import Array


@dataclass(frozen=True, slots=True)
class Reading:
    """What a source says. A consumer cannot write to it; its owner may once the step is over."""

    value: Array
    """`[B, ...]`, one row a scene, in the source's unit; or a `Query` whose answers are."""
    source: str
    step: int
    """Control step at which the value was valid."""


def _itself(answer: Any) -> Array:
    return answer


def _replaced(answer: Any, value: Array) -> Any:
    del answer
    return value


@dataclass(frozen=True, slots=True)
class Query:
    """The value of a reading that is a function: clearance at points, motion under commands.

    A tap delivers it as a function of one argument whose every answer passes the tap: faults act
    on each, and receipts count them. The n-th ask of a step has random numbers and a memory of its
    own, so an intervention that holds or delays gives the n-th ask what the n-th ask got before.
    """

    answer: Callable[[Any], Any]
    """What a request gets without a fault."""
    value: Callable[[Any], Array] = _itself
    """The array `[B, ...]` in an answer that faults act on, as the source declares it. It is
    called only where something looks at it."""
    changed: Callable[[Any, Array], Any] = _replaced
    """The answer with another such array in its place."""
