"""Deterministic interventions, on the value of a reading and on when it arrives.

Interventions that hold readings keep copies, so that a source may reuse its memory.
"""

import math
from typing import Literal, Self

import numpy as np
from pydantic import Field

from faultpath.core.arrays import Array, Constant, constant, copy, filled, is_zero, namespace
from faultpath.faults.base import Intervention, Memory, Moment, number
from faultpath.interface import Channel


class Scale(Intervention):
    """Multiply the reading by a factor."""

    kind: Literal["scale"] = "scale"
    phrase = "scaled by {factor}"
    factor: Constant

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading * factor`."""
        return reading * constant(self.factor, reading), None


class Offset(Intervention):
    """Add a number, or a vector along the last axis, in the reading's unit."""

    kind: Literal["offset"] = "offset"
    phrase = "offset by {by}"
    by: Constant

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + by`; an offset of zero does not even change the sign of a zero."""
        return (reading if is_zero(self.by) else reading + constant(self.by, reading)), None


class Rotate(Intervention):
    """Turn a vector by a rotation vector in radians, like a sensor that is mounted at an angle."""

    kind: Literal["rotate"] = "rotate"
    phrase = "turned by {by} rad"
    by: tuple[float, float, float]

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return R v for each vector v along the last axis; R turns by |by| about `by`."""
        if is_zero(self.by):
            return reading, None
        return namespace(reading).sum(
            reading[..., None, :] * constant(_turn(self.by), reading), axis=-1
        ), None

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse a reading that holds no vectors of three numbers."""
        if shape[-1:] == (3,):
            return None
        return f"the reading of one scene has shape {list(shape)}, which ends with no vector of 3"


def _turn(by: tuple[float, float, float]) -> Constant:
    """Return the rotation by |by| rad about `by` (Rodrigues)."""
    angle = math.hypot(*by)
    x, y, z = (part / angle for part in by)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return tuple(map(tuple, turned.tolist()))


class Quantise(Intervention):
    """Round to the nearest multiple of a step, halves to the even multiple."""

    kind: Literal["quantise"] = "quantise"
    phrase = "rounded to multiples of {step_size}"
    step_size: float = Field(gt=0)
    """In the reading's unit."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the rounded reading."""
        return namespace(reading).round(reading / self.step_size) * self.step_size, None


class Erase(Intervention):
    """Replace the reading by a default without information (paper: erasure)."""

    kind: Literal["erase"] = "erase"
    default: Constant | None = None
    """In the reading's unit; `None`: the erasure default that the channel declares."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the default; `ValueError` where `resolved` was not called first."""
        if self.default is None:
            raise ValueError("Erase has no default; resolve it against its channel first")
        return filled(self.default, reading), None

    def words(self) -> str:
        """Return `erased`, with the default if it has one."""
        return "erased" if self.default is None else f"erased to {number(self.default)}"

    def resolved(self, channel: Channel) -> Self:
        """Fill in the channel's erasure default where no other is given."""
        if self.default is not None:
            return self
        return self.model_copy(update={"default": channel.erasure_default})


class Delay(Intervention):
    """Deliver the reading of some steps before; the first reading until there is one that old."""

    kind: Literal["delay"] = "delay"
    phrase = "delayed by {steps} steps"
    steps: int = Field(ge=0)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the newest reading that is at least `steps` old, and the readings since then."""
        past = (*(memory or ()), (at.step, copy(reading)))
        while len(past) > 1 and past[1][0] <= at.step - self.steps:
            past = past[1:]
        return past[0][1], past


class Hold(Intervention):
    """Refresh the reading only at every n-th step from the onset on, as a lower rate would."""

    kind: Literal["hold"] = "hold"
    phrase = "refreshed every {every} steps"
    every: int = Field(ge=1)
    """Steps between two refreshes."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the held reading, refreshed when it is due."""
        value, last = memory or (None, None)
        refresh = at.elapsed // self.every
        if refresh != last or at.elapsed < 0:
            value = copy(reading)
        return value, (value, refresh)


class Freeze(Intervention):
    """Hold the reading of the onset (paper: freezing).

    Where a tap delivers nothing at the onset it is the last reading before, or else the first.
    """

    kind: Literal["freeze"] = "freeze"
    phrase = "frozen"

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the held reading; up to the onset that is the present one."""
        value = copy(reading) if memory is None or at.elapsed <= 0 else memory
        return value, value
