"""Interventions that probe what a reading is used for; no sensor fails this way."""

from typing import ClassVar, Literal

from pydantic import Field

from faultpath.core.arrays import Array, Constant, filled, namespace, place
from faultpath.faults.base import Intervention, Memory, Moment


class Replace(Intervention):
    """Deliver a fixed value, in the reading's unit, instead of the reading."""

    kind: Literal["replace"] = "replace"
    said = "replaced by {value}"
    value_field: ClassVar[str | None] = "value"
    value: Constant

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the value for every scene."""
        return filled(self.value, reading), None


class Shuffle(Intervention):
    """Permute a reading along one of its own axes, for instance the steps of a history.

    The permutation is drawn per scene and step. Scenes are never exchanged: a result would then
    depend on which other scenes run beside it.
    """

    kind: Literal["shuffle"] = "shuffle"
    said = "shuffled along axis {axis}"
    value_field: ClassVar[str | None] = "axis"
    axis: int = Field(default=1, ge=1)
    """Axis of `[B, ...]`; 1 is the first axis of one scene's reading."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the permuted reading."""
        if at.before:
            return reading, None
        xp = namespace(reading)
        order = place(at.draws.permutation(reading.shape[self.axis], at.step), reading)
        ones = [1] * (reading.ndim - 1)
        ones[self.axis - 1] = -1
        order = xp.broadcast_to(xp.reshape(order, (order.shape[0], *ones)), reading.shape)
        return xp.take_along_axis(reading, order, axis=self.axis), None

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse an axis that the reading does not have."""
        if self.axis <= len(shape):
            return None
        return f"axis {self.axis} does not exist: the reading of one scene has {len(shape)} axes"
