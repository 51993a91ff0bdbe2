"""Errors that last: growing since the onset, constant in a scene, or wandering slowly."""

from math import exp, sqrt
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from faultpath.core.arrays import (
    Array,
    Constant,
    HostArray,
    is_zero,
    like,
    namespace,
    pick,
    place,
    rows,
)
from faultpath.faults.base import Intervention, Memory, Moment, check_std, number, with_error


class Drift(Intervention):
    """Add an error that is zero at the onset and grows: a ramp, a random walk, or both."""

    kind: Literal["drift"] = "drift"
    value_field: ClassVar[str | None] = "rate_per_s"
    random: ClassVar[bool] = True
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
        xp = namespace(reading)
        seconds = rows(xp.astype(at.elapsed, xp.float64) * at.dt_s, reading)
        rate = place(np.asarray(self.rate_per_s, dtype=np.float64), reading)
        return xp.astype(rate * seconds, reading.dtype)

    def _walk(self, reading: Array, walk: Array, done: int, at: Moment) -> Array:
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


class Bias(Intervention):
    """Add a Gaussian error, constant in a scene or wandering as an Ornstein-Uhlenbeck process.

    The error is stationary: it has the deviation `std` at every step, and after `time_constant_s`
    a correlation of 1/e with itself (first-order Gauss-Markov, as for the biases of an IMU).
    """

    kind: Literal["bias"] = "bias"
    value_field: ClassVar[str | None] = "std"
    random: ClassVar[bool] = True
    std: Constant
    """In the reading's unit, or as a fraction of the reading when `relative`."""
    relative: bool = False
    time_constant_s: float | None = Field(default=None, gt=0)
    """`None`: constant in a scene."""

    @model_validator(mode="after")
    def _not_negative(self) -> Self:
        check_std(self.std)
        return self

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the process on the host in units of `std`, and the step that it stands at."""
        return at.draws.part(0).normal(tuple(reading.shape[1:]), 0), 0

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + std * x(t)`, or `reading * (1 + std * x(t))` when relative."""
        if at.before or is_zero(self.std):
            return reading, memory
        process = self._moved_on(memory[0], memory[1], at)
        return with_error(reading, np.asarray(self.std) * process, self.relative), (
            process,
            at.step,
        )

    def _moved_on(self, process: HostArray, done: int, at: Moment) -> HostArray:
        if self.time_constant_s is None:
            return process
        stays = exp(-at.dt_s / self.time_constant_s)
        for step in range(done + 1, at.step + 1):
            draw = at.draws.normal(process.shape[1:], step)
            process = stays * process + sqrt(1 - stays**2) * draw
        return process

    def words(self) -> str:
        """Return `bias of std STD`, and how long it lasts."""
        what = f"{'relative ' if self.relative else ''}bias of std {number(self.std)}"
        if self.time_constant_s is None:
            return f"{what}, one draw a scene"
        return f"{what}, wandering with a time constant of {number(self.time_constant_s)} s"
