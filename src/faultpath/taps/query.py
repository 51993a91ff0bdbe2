"""A source that its consumer asks within a step, as often as it wants."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from faultpath.arrays import Array


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
