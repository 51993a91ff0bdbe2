"""Interventions that add error: fresh at every step, or growing since the onset."""

from math import sqrt
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from faultpath.arrays import (
    Array,
    Constant,
    is_zero,
    like,
    misfit,
    namespace,
    pick,
    place,
    rows,
)
from faultpath.faults.base import Intervention, Memory, Moment, number


class Noise(Intervention):
    """Add Gaussian noise, drawn anew at every step and for every number of the reading."""

    kind: Literal["noise"] = "noise"
    value_field: ClassVar[str | None] = "std"
    std: Constant
    """In the reading's unit, or as a fraction of the reading when `relative`."""
    relative: bool = False

    @model_validator(mode="after")
    def _not_negative(self) -> Self:
        if np.any(np.asarray(self.std) < 0):
            raise ValueError("std must not be negative")
        return self

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + std * n`, or `reading * (1 + std * n)` when relative."""
        if at.before or is_zero(self.std):
            return reading, None
        error = np.asarray(self.std) * at.draws.normal(tuple(reading.shape[1:]), at.step)
        if self.relative:
            return reading * like(1 + error, reading), None
        return reading + like(error, reading), None

    def words(self) -> str:
        """Return `noise of std STD`."""
        return f"{'relative ' if self.relative else ''}noise of std {number(self.std)}"

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse a deviation whose shape the reading does not have."""
        return misfit("std", self.std, shape)


class Drift(Intervention):
    """Add an error that is zero at the onset and grows: a ramp, a random walk, or both."""

    kind: Literal["drift"] = "drift"
    value_field: ClassVar[str | None] = "rate_per_s"
    rate_per_s: Constant = 0.0
    """Ramp, in the reading's unit per second."""
    walk_per_sqrt_s: float = Field(default=0.0, ge=0)
    """Random walk: standard deviation after one second, in the reading's unit."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the walk so far, zero, and the last step that it holds."""
        return namespace(reading).zeros_like(reading), 0

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + rate * t + walk(t)`, where t is the time since the onset."""
        walk, done = memory
        if isinstance(at.elapsed, int):
            if at.elapsed <= 0:
                return reading, (walk, at.step)
            seconds = np.asarray(at.elapsed * at.dt_s)
            ramp = like(np.asarray(self.rate_per_s) * seconds, reading)
        else:
            ramp = self._ramp(reading, at)
        walk = self._walk(reading, walk, done, at)
        value = reading
        if not is_zero(self.rate_per_s):
            value = value + ramp
        if self.walk_per_sqrt_s:
            value = value + walk
        return pick(at.elapsed > 0, value, reading), (walk, at.step)

    def _ramp(self, reading: Array, at: Moment) -> Array:
        """Return the ramp of scenes with onsets of their own; float64 as on the host."""
        xp = namespace(reading)
        seconds = rows(xp.astype(at.elapsed, xp.float64) * at.dt_s, reading)
        rate = place(np.asarray(self.rate_per_s, dtype=np.float64), reading)
        return xp.astype(rate * seconds, reading.dtype)

    def _walk(self, reading: Array, walk: Array, done: int, at: Moment) -> Array:
        """Return the walk at this step; steps without a delivery count, so consumers agree."""
        if not self.walk_per_sqrt_s:
            return walk
        deviation = self.walk_per_sqrt_s * sqrt(at.dt_s)
        for step in range(done + 1, at.step + 1):
            begun = at.elapsed - (at.step - step) > 0
            if begun is False:
                continue
            draw = at.draws.normal(tuple(reading.shape[1:]), step)
            walk = pick(begun, walk + like(deviation * draw, reading), walk)
        return walk

    def words(self) -> str:
        """Return the growth in words."""
        ramp = f"drift of {number(self.rate_per_s)} per s"
        walk = f"random walk of {number(self.walk_per_sqrt_s)} per sqrt(s)"
        if not self.walk_per_sqrt_s:
            return ramp
        return walk if is_zero(self.rate_per_s) else f"{ramp} and {walk}"

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse a rate whose shape the reading does not have."""
        return misfit("rate_per_s", self.rate_per_s, shape)
