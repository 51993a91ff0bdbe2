"""Interventions on the value of a reading that need no past."""

from typing import ClassVar, Literal, Self

from pydantic import Field

from faultpath.core.arrays import Array, Constant, constant, filled, is_zero, namespace
from faultpath.faults.base import Intervention, Memory, Moment, number
from faultpath.interface import Channel


class Scale(Intervention):
    """Multiply the reading by a factor."""

    kind: Literal["scale"] = "scale"
    said = "scaled by {factor}"
    value_field: ClassVar[str | None] = "factor"
    factor: Constant

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading * factor`."""
        return reading * constant(self.factor, reading), None


class Offset(Intervention):
    """Add a number, or a vector along the last axis, in the reading's unit."""

    kind: Literal["offset"] = "offset"
    said = "offset by {by}"
    value_field: ClassVar[str | None] = "by"
    by: Constant

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + by`; an offset of zero leaves even the sign of a zero alone."""
        return (reading if is_zero(self.by) else reading + constant(self.by, reading)), None


class Quantise(Intervention):
    """Round to the nearest multiple of a step, halves to the even multiple."""

    kind: Literal["quantise"] = "quantise"
    said = "rounded to multiples of {step_size}"
    value_field: ClassVar[str | None] = "step_size"
    step_size: float = Field(gt=0)
    """In the reading's unit."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the rounded reading."""
        return namespace(reading).round(reading / self.step_size) * self.step_size, None


class Erase(Intervention):
    """Replace the reading by a default that carries no information (paper: erasure)."""

    kind: Literal["erase"] = "erase"
    value_field: ClassVar[str | None] = "default"
    default: Constant | None = None
    """In the reading's unit; `None`: the erasure default that the channel declares."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the default; raises `ValueError` before `resolved` has supplied one."""
        if self.default is None:
            raise ValueError("Erase has no default; resolve it against its channel first")
        return filled(self.default, reading), None

    def words(self) -> str:
        """Return `erased`, with the default where one is given."""
        return "erased" if self.default is None else f"erased to {number(self.default)}"

    def resolved(self, channel: Channel) -> Self:
        """Take the channel's erasure default where no other is given."""
        if self.default is not None:
            return self
        return self.model_copy(update={"default": channel.erasure_default})
