"""The disturbance observer (DOB): what the nominal model does not explain is taken for wind."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import so3
from faultpath_quadrotor.predictors import Calibration
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.reconstruction.base import Delivered, Memory, Read, Reconstruction
from faultpath_quadrotor.vehicle import (
    CONTROL_DT_S,
    GRAVITY_MPS2,
    NOMINAL_MOTOR_TIME_CONSTANT_S,
)

LOW_PASS = 0.5  # paper, appendix: fixed before held-out evaluation


@dataclass(frozen=True)
class Sensed:
    """What the observer's taps delivered at this step, batch `[*batch]`."""

    velocity_mps: Tensor
    """World frame, `[3, *batch]`."""
    rotation: Tensor
    """Body to world, `[3, 3, *batch]`."""
    executed: Tensor
    """Command executed over the interval that has just ended, `[4, *batch]`."""
    nominal: Calibration
    """Calibration of the nominal dynamics."""
    wind_map_mass_kg: Tensor
    """Mass that the wind map is inverted with, `[*batch]`."""

    @classmethod
    def of(cls, delivered: Delivered) -> "Sensed":
        """Name what was delivered."""
        return cls(
            velocity_mps=delivered["velocity", "velocity_difference"],
            rotation=delivered["attitude", "nominal_model"],
            executed=delivered["action", "nominal_model"],
            nominal=Calibration(
                delivered["mass", "nominal_model"], delivered["thrust_scale", "nominal_model"]
            ),
            wind_map_mass_kg=delivered["mass", "wind_map"],
        )


@dataclass(frozen=True)
class ObserverMemory:
    """The estimate, and what the next difference needs."""

    wind_mps: Tensor
    thrust_n: Tensor
    """Thrust that the motors are believed to hold at this moment, N."""
    before: Sensed


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
        first = Sensed.of(delivered)
        return ObserverMemory(
            wind_mps=torch.zeros_like(first.velocity_mps),
            thrust_n=first.nominal.hover_thrust(GRAVITY_MPS2),
            before=first,
        )

    @override
    def update(self, memory: Memory, delivered: Delivered) -> Memory:
        now: ObserverMemory = memory
        sensed = Sensed.of(delivered)
        middle = _halfway(now.before.rotation, sensed.rotation)
        residual = self.observed(now, sensed) - self.nominal(now, sensed)
        raw = self._air.inverse(middle, residual * sensed.wind_map_mass_kg)
        command = sensed.executed[0]
        return ObserverMemory(
            wind_mps=torch.lerp(now.wind_mps, raw, self._alpha),
            thrust_n=command + (now.thrust_n - command) * self._keep,
            before=sensed,
        )

    @override
    def wind(self, memory: Memory) -> Tensor:
        return memory.wind_mps

    def observed(self, memory: ObserverMemory, sensed: Sensed) -> Tensor:
        """Mean acceleration over the interval, `[3, *batch]`, m/s^2."""
        return (sensed.velocity_mps - memory.before.velocity_mps) / self._dt

    def nominal(self, memory: ObserverMemory, sensed: Sensed) -> Tensor:
        """Acceleration a_0 that thrust, gravity and drag explain, `[3, *batch]`, m/s^2."""
        command = sensed.executed[0]
        thrust = command + (memory.thrust_n - command) * self._mean
        middle = _halfway(memory.before.rotation, sensed.rotation)
        calibration = sensed.nominal
        acceleration = middle[:, 2] * (calibration.thrust_scale * thrust / calibration.mass_kg)
        velocity = 0.5 * (memory.before.velocity_mps + sensed.velocity_mps)
        acceleration += self._air.force(middle, -velocity) / calibration.mass_kg
        acceleration[2] -= GRAVITY_MPS2
        return acceleration


def _halfway(before: Tensor, after: Tensor) -> Tensor:
    turn = so3.log(so3.compose(before.transpose(0, 1), after))
    return so3.compose(before, so3.exp(0.5 * turn))
