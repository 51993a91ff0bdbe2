"""Interventions with random errors: new at every step, once a scene, wandering, or growing."""

from math import exp, sqrt
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field

from faultpath.core.arrays import (
    Array,
    Constant,
    HostArray,
    copy,
    is_zero,
    like,
    match_device,
    namespace,
    pick,
    rows,
)
from faultpath.faults.base import Intervention, Memory, Moment, number
from faultpath.faults.values import Erase
from faultpath.interface import Channel


def _not_negative(std: Constant) -> Constant:
    if np.any(np.asarray(std) < 0):
        raise ValueError("must not be negative")
    return std


Std = Annotated[Constant, AfterValidator(_not_negative)]
"""A standard deviation for each number of a reading, or one for all."""


def _with_error(reading: Array, error: HostArray, relative: bool) -> Array:
    return reading * like(1 + error, reading) if relative else reading + like(error, reading)


class Noise(Intervention):
    """Add Gaussian noise, drawn at every step and for every number of the reading."""

    kind: Literal["noise"] = "noise"
    random: ClassVar[bool] = True
    std: Std
    """In the reading's unit, or as a fraction of the reading when `relative`."""
    relative: bool = False

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + std * n`, or `reading * (1 + std * n)` when relative."""
        if at.elapsed < 0 or is_zero(self.std):
            return reading, None
        error = np.asarray(self.std) * at.draws.normal(tuple(reading.shape[1:]), at.step)
        return _with_error(reading, error, self.relative), None

    def words(self) -> str:
        """Return `noise of std STD`."""
        return f"{'relative ' if self.relative else ''}noise of std {number(self.std)}"


class UniformScale(Intervention):
    """Multiply by a factor drawn once per scene, uniform in 1 ± half_range.

    It is the calibration noise of DCC training (paper, "Interventions and Evidence": ± 20 %, one
    draw a window, held throughout). Channels of different causes draw independently.
    """

    kind: Literal["uniform_scale"] = "uniform_scale"
    phrase = "scaled by 1 ± {half_range}, one draw a scene"
    random: ClassVar[bool] = True
    half_range: float = Field(ge=0, lt=1)

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the factors, one a scene."""
        unit = 2 * at.draws.uniform((), 0) - 1
        return rows(like(1 + self.half_range * unit, reading), reading)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading * factor of the scene`."""
        return reading * memory, memory


class Bias(Intervention):
    """Add a Gaussian error, constant in a scene or wandering as an Ornstein-Uhlenbeck process.

    The error is stationary: it has the deviation `std` at every step, and after `time_constant_s`
    a correlation of 1/e with itself (first-order Gauss-Markov, as for the biases of an IMU).
    """

    kind: Literal["bias"] = "bias"
    random: ClassVar[bool] = True
    std: Std
    """In the reading's unit, or as a fraction of the reading when `relative`."""
    relative: bool = False
    time_constant_s: float | None = Field(default=None, gt=0)
    """`None`: constant in a scene."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the process on the host in units of `std`, and the step it has reached."""
        return at.draws.beside("/0").normal(tuple(reading.shape[1:]), 0), 0

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + std * x(t)`, or `reading * (1 + std * x(t))` when relative."""
        if at.elapsed < 0 or is_zero(self.std):
            return reading, memory
        process, reached = memory
        if self.time_constant_s is not None:
            kept = exp(-at.dt_s / self.time_constant_s)
            for step in range(reached + 1, at.step + 1):
                draw = at.draws.normal(process.shape[1:], step)
                process = kept * process + sqrt(1 - kept**2) * draw
        error = np.asarray(self.std) * process
        return _with_error(reading, error, self.relative), (process, at.step)

    def words(self) -> str:
        """Return `bias of std STD`, and its time constant."""
        what = f"{'relative ' if self.relative else ''}bias of std {number(self.std)}"
        if self.time_constant_s is None:
            return f"{what}, one draw a scene"
        return f"{what}, wandering with a time constant of {number(self.time_constant_s)} s"


class Drift(Intervention):
    """Add an error that is zero at the onset and grows: a ramp, a random walk, or both."""

    kind: Literal["drift"] = "drift"
    random: ClassVar[bool] = True
    rate_per_s: Constant = 0.0
    """Ramp, in the reading's unit per second."""
    walk_per_sqrt_s: float = Field(default=0.0, ge=0)
    """Random walk: standard deviation after one second, in the reading's unit."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the random walk, at zero, and the step it has reached."""
        return namespace(reading).zeros_like(reading), 0

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return `reading + rate * t + walk(t)`, where t is the time since the onset."""
        walk, reached = memory
        if at.elapsed <= 0:
            return reading, (walk, at.step)
        value = reading
        if not is_zero(self.rate_per_s):
            seconds = np.asarray(at.elapsed * at.dt_s)
            value = value + like(np.asarray(self.rate_per_s) * seconds, reading)
        if self.walk_per_sqrt_s:
            deviation = self.walk_per_sqrt_s * sqrt(at.dt_s)
            onset = at.step - at.elapsed
            for step in range(max(reached, onset) + 1, at.step + 1):
                draw = at.draws.normal(tuple(reading.shape[1:]), step)
                walk = walk + like(deviation * draw, reading)
            value = value + walk
        return value, (walk, at.step)

    def words(self) -> str:
        """Return the growth in words."""
        ramp = f"drift of {number(self.rate_per_s)} per s"
        walk = f"random walk of {number(self.walk_per_sqrt_s)} per sqrt(s)"
        if not self.walk_per_sqrt_s:
            return ramp
        return walk if is_zero(self.rate_per_s) else f"{ramp} and {walk}"


class Dropout(Intervention):
    """Lose each reading with a probability, drawn per scene and step."""

    kind: Literal["dropout"] = "dropout"
    random: ClassVar[bool] = True
    probability: float = Field(ge=0, le=1)
    substitute: Erase | None = None
    """Value in place of a lost reading; `None`: the last that arrived, or else the first."""

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the last reading that arrived."""
        return copy(reading)

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the reading where it arrives, and the substitute where it is lost."""
        if at.elapsed < 0 or not self.probability:
            return reading, copy(reading)
        arrives = match_device(at.draws.uniform((), at.step) >= self.probability, reading)
        last = pick(arrives, reading, memory)
        if self.substitute is None:
            return last, last
        erased, _ = self.substitute.apply(reading, None, at)
        return pick(arrives, reading, erased), last

    def words(self) -> str:
        """Return `lost with probability PROBABILITY`, and what is delivered then."""
        instead = "held" if self.substitute is None else self.substitute.words()
        return f"lost with probability {number(self.probability)}, then {instead}"

    def resolved(self, channel: Channel) -> Self:
        """Take the channel's erasure default where the substitute names none."""
        if self.substitute is None:
            return self
        return self.model_copy(update={"substitute": self.substitute.resolved(channel)})

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse a substitute that the reading does not fit."""
        return None if self.substitute is None else self.substitute.misfit(shape)


class Shuffle(Intervention):
    """Permute a reading along one of its own axes, for instance the steps of a history.

    The permutation is drawn per scene and step. Scenes are never exchanged, because a result would
    then depend on the other scenes of its block.
    """

    kind: Literal["shuffle"] = "shuffle"
    phrase = "shuffled along axis {axis}"
    axis: int = Field(default=1, ge=1)
    """Axis of `[B, ...]`; 1 is the first axis of one scene's reading."""

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the permuted reading."""
        if at.elapsed < 0:
            return reading, None
        xp = namespace(reading)
        order = match_device(at.draws.permutation(reading.shape[self.axis], at.step), reading)
        ones = [1] * (reading.ndim - 1)
        ones[self.axis - 1] = -1
        order = xp.broadcast_to(xp.reshape(order, (order.shape[0], *ones)), reading.shape)
        return xp.take_along_axis(reading, order, axis=self.axis), None

    def misfit(self, shape: tuple[int, ...]) -> str | None:
        """Refuse an axis that the reading does not have."""
        if self.axis <= len(shape):
            return None
        return f"axis {self.axis} does not exist: the reading of one scene has {len(shape)} axes"
