"""The waypoint controller that flies the training episodes.

It is part of the simulator, not of what is audited: it knows the true state, mass, thrust scale
and wind, and passes through no tap.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.signal import lfilter
from torch import Tensor

from faultpath_quadrotor import so3
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.platform import ControllerSettings, PerturbationSettings
from faultpath_quadrotor.state import Batched, State
from faultpath_quadrotor.vehicle import (
    COLLECTIVE_MAX_N,
    CONTROL_RATE_HZ,
    GRAVITY_MPS2,
    RATE_LIMIT_RADPS,
)

Array = NDArray[np.float64]


class Perturbation(NamedTuple):
    """The perturbation of one episode, for each control step."""

    offset: Array
    """[4, N]: thrust as a fraction of the hover thrust, body rates in rad/s."""
    holds: NDArray[np.bool_]
    """[N]: whether the controller's command of the step before is used again, below the offset."""


def draw(stream: np.random.Generator, steps: int, settings: PerturbationSettings) -> Perturbation:
    """Return the perturbation of an episode of `steps` control steps, drawn from `stream`."""
    clean = stream.uniform() < settings.clean_share
    low, high = (0.0, settings.clean_strength) if clean else (settings.clean_strength, 1.0)
    thrust, rates = stream.uniform(low, high, 2)
    sigma = np.array((settings.thrust_sigma, *settings.rate_sigma_radps))
    sigma *= np.array((thrust, rates, rates, rates))
    # Stationary AR(1) noise of unit standard deviation.
    correlation = stream.uniform(*settings.correlation)
    fresh = np.sqrt(1 - correlation**2)
    innovations = fresh * stream.standard_normal((4, steps))
    innovations[:, 0] /= fresh
    noise = lfilter([1.0], [1.0, -correlation], innovations, axis=1)
    jitter = stream.uniform(0.0, settings.jitter) * stream.standard_normal((4, steps))
    pulses = np.zeros((4, steps))
    for _ in range(stream.poisson(settings.pulses_per_s * steps / CONTROL_RATE_HZ)):
        # A held step of one axis or, every other time, a doublet: a step and its reverse.
        axis, first = stream.integers(4), stream.integers(steps)
        width = stream.integers(*settings.pulse_steps, endpoint=True)
        height = stream.uniform(*settings.pulse_sigmas) * stream.choice((-1.0, 1.0))
        pulses[axis, first : first + width] += height
        if stream.uniform() < 0.5:
            pulses[axis, first + width : first + 2 * width] -= height
    holds = np.zeros(steps, dtype=bool)
    for _ in range(stream.poisson(high * settings.holds_per_s * steps / CONTROL_RATE_HZ)):
        first = stream.integers(1, steps)
        holds[first : first + stream.integers(*settings.hold_steps, endpoint=True)] = True
    return Perturbation(sigma[:, None] * (noise + jitter + pulses), holds)


LEAST_LIFT = 0.3
"""The commanded vertical specific force is at least this part of gravity: the vehicle never turns
over to fall faster."""
_TINY = 1e-12
"""Added to norms that divide: their quotients are then zero at zero."""


@dataclass(frozen=True)
class Course(Batched):
    """Plan of the controller for a batch of episodes; M waypoints, N control steps, *b lanes."""

    waypoint_m: Tensor
    """[3, M, *b]"""
    speed_mps: Tensor
    """[M, *b]"""
    leg_s: Tensor
    """[M, *b]"""
    heading_offset_rad: Tensor
    """[M, *b]"""
    gains: Tensor
    """Position, velocity, attitude and heading gain in 1/s, [4, *b]."""
    tilt_slope: Tensor
    """Tangent of the largest tilt commanded, [*b]."""
    drag_share: Tensor
    """[*b]"""
    offset: Tensor
    """`Perturbation.offset`, [4, N, *b]."""
    holds: Tensor
    """`Perturbation.holds`, [N, *b]."""

    @classmethod
    def draw(
        cls, stream: np.random.Generator, settings: ControllerSettings, perturbation: Perturbation
    ) -> Course:
        """Return the course of one episode, without batch axes."""
        count = settings.waypoints
        lows, highs = np.array(settings.arena_m).T
        values = {
            "waypoint_m": stream.uniform(lows[:, None], highs[:, None], (3, count)),
            "speed_mps": stream.uniform(*settings.speed_mps, count),
            "leg_s": stream.uniform(*settings.leg_s, count),
            "heading_offset_rad": settings.heading_offset_rad * stream.uniform(-1, 1, count),
            "gains": np.array(
                [
                    stream.uniform(*settings.position_gain_per_s),
                    stream.uniform(*settings.velocity_gain_per_s),
                    stream.uniform(*settings.attitude_gain_per_s),
                    stream.uniform(*settings.heading_gain_per_s),
                ]
            ),
            "tilt_slope": np.tan(np.radians(stream.uniform(*settings.tilt_limit_deg))),
            "drag_share": np.array(stream.uniform(*settings.drag_share)),
            "offset": perturbation.offset,
            "holds": perturbation.holds,
        }
        return cls(**{name: torch.as_tensor(value) for name, value in values.items()})


class WaypointController:
    """Position to velocity to acceleration to thrust and attitude to body rates, at 20 Hz.

    A cascade of proportional loops, the attitude by the reduced error of Brescianini, Hehn and
    D'Andrea (2013, "Nonlinear quadrocopter attitude control"): thrust direction first, heading
    for itself. All operations are elementwise over lanes.
    """

    def __init__(self, vehicle: Vehicle, course: Course, arrival_m: float) -> None:
        self._vehicle = vehicle
        self._course = course
        self._arrival_m = arrival_m
        self._leg = torch.zeros_like(vehicle.mass_kg, dtype=torch.long)
        self._on_leg_s = torch.zeros_like(vehicle.mass_kg)
        self._last = vehicle.hover_command()
        self._limit = torch.tensor(RATE_LIMIT_RADPS).to(vehicle.mass_kg)[:, None]

    def command(self, step: int, state: State, wind_mps: Tensor) -> Tensor:
        """Return the perturbed command [4, L] of a control step, within the vehicle's limits.

        It is rounded to single precision, so that what is recorded is what was flown.
        """
        fresh = self._feedback(state, wind_mps)
        self._last = torch.where(self._course.holds[step], self._last, fresh)
        offset = self._course.offset[:, step]
        thrust = self._last[0] + offset[0] * self._vehicle.hover_thrust_n
        rate = torch.clamp(self._last[1:] + offset[1:], -self._limit, self._limit)
        command = torch.cat((thrust.clamp(0.0, COLLECTIVE_MAX_N)[None], rate))
        return command.float().to(command.dtype)

    def _feedback(self, state: State, wind_mps: Tensor) -> Tensor:
        """Return the command [4, L] that the state and the leg ask for."""
        course, vehicle = self._course, self._vehicle
        velocity = course.gains[0] * self._way(state.position)
        speed = (velocity * velocity).sum(0).sqrt() + _TINY
        velocity = velocity * (self._at_leg(course.speed_mps) / speed).clamp(max=1.0)

        air = so3.rotate_back(state.rotation, wind_mps - state.velocity)
        drag = so3.rotate(state.rotation, vehicle.drag_kgps * air) / vehicle.mass_kg
        force = course.gains[1] * (velocity - state.velocity) - course.drag_share * drag
        up = (force[2] + GRAVITY_MPS2).clamp(min=LEAST_LIFT * GRAVITY_MPS2)
        level = (force[0] * force[0] + force[1] * force[1]).sqrt() + _TINY
        shrink = (course.tilt_slope * up / level).clamp(max=1.0)
        force = torch.stack((force[0] * shrink, force[1] * shrink, up))
        lift = (state.rotation[:, 2] * force).sum(0)
        thrust = lift * vehicle.mass_kg / vehicle.thrust_scale

        direction = so3.rotate_back(state.rotation, force)
        sine = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt() + _TINY
        tilt = course.gains[2] * torch.atan2(sine, direction[2]) / sine
        travel = torch.atan2(velocity[1], velocity[0])
        heading = torch.atan2(state.rotation[1, 0], state.rotation[0, 0])
        error = travel + self._at_leg(course.heading_offset_rad) - heading
        error = error - 2 * math.pi * torch.round(error / (2 * math.pi))
        rate = torch.stack((-direction[1] * tilt, direction[0] * tilt, course.gains[3] * error))
        return torch.cat((thrust[None], torch.clamp(rate, -self._limit, self._limit)))

    def _way(self, position: Tensor) -> Tensor:
        left = self._at_leg(self._course.waypoint_m) - position
        arrived = (left * left).sum(0).sqrt() < self._arrival_m
        late = self._on_leg_s >= self._at_leg(self._course.leg_s)
        turn = (arrived | late) & (self._leg < self._course.leg_s.shape[0] - 1)
        self._leg = self._leg + turn
        self._on_leg_s = torch.where(turn, 0.0, self._on_leg_s + 1 / CONTROL_RATE_HZ)
        return self._at_leg(self._course.waypoint_m) - position

    def _at_leg(self, values: Tensor) -> Tensor:
        index = self._leg.expand(*values.shape[:-2], 1, -1)
        return values.gather(-2, index).squeeze(-2)
