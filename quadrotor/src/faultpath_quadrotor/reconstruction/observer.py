"""The disturbance observer (DOB): what the nominal model does not explain is taken for wind."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import so3
from faultpath_quadrotor.lanes import Delivered, Read
from faultpath_quadrotor.predictors.base import hover_thrust
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.reconstruction.base import Memory, Reconstruction
from faultpath_quadrotor.vehicle import (
    CONTROL_DT_S,
    GRAVITY_MPS2,
    NOMINAL_MOTOR_TIME_CONSTANT_S,
)

LOW_PASS = 0.5  # paper, appendix: fixed before held-out evaluation


@dataclass(frozen=True)
class ObserverMemory:
    """The estimate, and what the next difference needs."""

    wind_mps: Tensor
    thrust_n: Tensor
    """Thrust that the motors are believed to hold at this moment, N."""
    before: Delivered


class DisturbanceObserver(Reconstruction):
    """Velocity difference minus nominal thrust, gravity and drag, through the inverse wind map.

    Two details decide its error. Thrust acts along the attitude in the middle of the interval: the
    attitude at its start errs by up to 0.7 m/s^2 at 3 rad/s. And the thrust is the commanded one
    after the nominal motor lag, averaged over the interval: 57 % of a step in thrust is not yet
    there in its first interval. The estimate starts at zero, is low-pass filtered, and is never
    clipped (paper, Section V-B and appendix).
    """

    reads: frozenset[Read] = frozenset(
        {
            ("velocity", "velocity_difference"),
            ("attitude", "nominal_model"),
            ("action", "nominal_model"),
            ("mass", "nominal_model"),
            ("thrust_scale", "nominal_model"),
            ("mass", "wind_map"),
        }
    )

    def __init__(
        self,
        drag_kgps: Sequence[float],
        low_pass: float = LOW_PASS,
        dt_s: float = CONTROL_DT_S,
    ) -> None:
        self._alpha = low_pass
        self._dt = dt_s
        self._air = LinearDrag(drag_kgps)
        lag = NOMINAL_MOTOR_TIME_CONSTANT_S
        self._keep = math.exp(-dt_s / lag)
        self._mean = lag / dt_s * (1 - self._keep)

    def begin(self, delivered: Delivered) -> Memory:
        """Start at zero wind, with the motors believed to hover."""
        return ObserverMemory(
            wind_mps=torch.zeros_like(delivered["velocity", "velocity_difference"]),
            thrust_n=hover_thrust(delivered, "nominal_model"),
            before=delivered,
        )

    @override
    def update(self, memory: Memory, delivered: Delivered) -> Memory:
        now: ObserverMemory = memory
        middle = _halfway(now, delivered)
        residual = self.observed(now, delivered) - self.nominal(now, delivered)
        raw = self._air.inverse(middle, residual * delivered["mass", "wind_map"])
        command = delivered["action", "nominal_model"][0]
        return ObserverMemory(
            wind_mps=torch.lerp(now.wind_mps, raw, self._alpha),
            thrust_n=command + (now.thrust_n - command) * self._keep,
            before=delivered,
        )

    @override
    def wind(self, memory: Memory) -> Tensor:
        return memory.wind_mps

    def observed(self, memory: ObserverMemory, delivered: Delivered) -> Tensor:
        """Mean acceleration over the interval, `[3, *batch]`, m/s^2."""
        read = ("velocity", "velocity_difference")
        return (delivered[read] - memory.before[read]) / self._dt

    def nominal(self, memory: ObserverMemory, delivered: Delivered) -> Tensor:
        """Acceleration a_0 that thrust, gravity and drag explain, `[3, *batch]`, m/s^2."""
        command = delivered["action", "nominal_model"][0]
        thrust = command + (memory.thrust_n - command) * self._mean
        mass_kg, thrust_scale = (
            delivered[channel, "nominal_model"] for channel in ("mass", "thrust_scale")
        )
        middle = _halfway(memory, delivered)
        acceleration = middle[:, 2] * (thrust_scale * thrust / mass_kg)
        read = ("velocity", "velocity_difference")
        velocity = 0.5 * (memory.before[read] + delivered[read])
        acceleration += self._air.force(middle, -velocity) / mass_kg
        acceleration[2] -= GRAVITY_MPS2
        return acceleration


def _halfway(memory: ObserverMemory, delivered: Delivered) -> Tensor:
    """Return the attitude in the middle of the interval."""
    read = ("attitude", "nominal_model")
    before, after = memory.before[read], delivered[read]
    turn = so3.log(so3.compose(before.transpose(0, 1), after))
    return so3.compose(before, so3.exp(0.5 * turn))
