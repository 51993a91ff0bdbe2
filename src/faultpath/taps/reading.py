"""A source's value at a step."""

from dataclasses import dataclass

from faultpath.arrays import Array


@dataclass(frozen=True, slots=True)
class Reading:
    """What a source says. A consumer cannot write to it; its owner may once the step is over."""

    value: Array
    """`[B, ...]`, one row a scene, in the source's unit; or a `Query` whose answers are."""
    source: str
    step: int
    """Control step at which the value was valid."""
