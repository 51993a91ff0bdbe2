"""The disturbance observer (DOB): what the nominal model does not explain is taken for wind."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import so3
from faultpath_quadrotor.batching import Delivered, Read
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.reconstruction.base import Memory, Reconstruction
from faultpath_quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2

LOW_PASS = 0.5  # paper, appendix: fixed before held-out evaluation


@dataclass(frozen=True)
class ObserverMemory:
    """The estimate, and what the next difference needs."""

    wind_mps: Tensor
    velocity_mps: Tensor


class DisturbanceObserver(Reconstruction):
    """Velocity difference minus nominal thrust, gravity and drag, through the inverse wind map.

    An interval is the command executed over it and the state at its end, as for the recurrent
    modules (paper, appendix): the nominal model has no motor lag and no turn within the interval.
    The estimate starts at zero, is low-pass filtered, and is never clipped (paper, Section V-B).
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

    def __init__(self, drag_kgps: Sequence[float]) -> None:
        self._air = LinearDrag(drag_kgps)

    def begin(self, delivered: Delivered) -> Memory:
        """Start at zero wind."""
        velocity = delivered["velocity", "velocity_difference"]
        return ObserverMemory(torch.zeros_like(velocity), velocity)

    @override
    def update(self, memory: ObserverMemory, delivered: Delivered) -> Memory:
        velocity = delivered["velocity", "velocity_difference"]
        residual = self.observed(memory, delivered) - self.nominal(delivered)
        raw = self._air.inverse(
            delivered["attitude", "nominal_model"], residual * delivered["mass", "wind_map"]
        )
        return ObserverMemory(torch.lerp(memory.wind_mps, raw, LOW_PASS), velocity)

    def observed(self, memory: ObserverMemory, delivered: Delivered) -> Tensor:
        """Return the acceleration of the last interval, `[3, *batch]`, m/s^2."""
        velocity = delivered["velocity", "velocity_difference"]
        return (velocity - memory.velocity_mps) / CONTROL_DT_S

    @override
    def wind(self, memory: Memory) -> Tensor:
        return memory.wind_mps

    def nominal(self, delivered: Delivered) -> Tensor:
        """Return the acceleration a_0 of thrust, gravity and drag, `[3, *batch]`, m/s^2."""
        attitude, mass_kg, thrust_scale = (
            delivered[channel, "nominal_model"] for channel in ("attitude", "mass", "thrust_scale")
        )
        thrust = delivered["action", "nominal_model"][0]
        acceleration = attitude[:, 2] * (thrust_scale * thrust / mass_kg)
        velocity = delivered["velocity", "velocity_difference"]
        acceleration += self._air.force(attitude, -velocity) / mass_kg
        acceleration[2] -= GRAVITY_MPS2
        return acceleration


class InertialObserver(DisturbanceObserver):
    """The same from the accelerometer's innovation: its reading minus the expected one.

    It uses the last 10 ms of the interval, when the motors have followed the command best. The
    sensor's bias and the attitude's error enter the wind.
    """

    reads = DisturbanceObserver.reads | {("accelerometer", "innovation")}

    @override
    def observed(self, memory: ObserverMemory, delivered: Delivered) -> Tensor:
        force = delivered["accelerometer", "innovation"][-1]
        acceleration = so3.rotate(delivered["attitude", "nominal_model"], force)
        acceleration[2] -= GRAVITY_MPS2
        return acceleration
