"""The reference plant in torch: a batch of vehicles, stepped at 500 Hz under held commands."""

from __future__ import annotations

import math

import torch
from torch import Tensor

from faultpath_quadrotor import native, so3
from faultpath_quadrotor.native.kernel_args import covered
from faultpath_quadrotor.plant.compiled import CompiledPlant
from faultpath_quadrotor.plant.protocol import Plant, PlantState, Standing, Vehicle
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import (
    ARM_LENGTH_M,
    COLLECTIVE_MAX_N,
    GRAVITY_MPS2,
    MOTOR_THRUST_MAX_N,
    PLANT_DT_S,
    RATE_GAIN_PER_S,
    RATE_LIMIT_RADPS,
    TORQUE_COEFFICIENT_M,
)

_ARM = ARM_LENGTH_M * math.sqrt(0.5)
WRENCH_PER_THRUST = (
    (1.0, 1.0, 1.0, 1.0),
    (_ARM, _ARM, -_ARM, -_ARM),  # y of the motors
    (-_ARM, _ARM, _ARM, -_ARM),  # minus x
    tuple(sign * TORQUE_COEFFICIENT_M for sign in (1.0, -1.0, 1.0, -1.0)),
)
"""Collective thrust (N) and body torque (N m) per newton of each motor: 4 x 4 with orthogonal
rows, so its inverse is its transpose over the rows' squared norms."""


def column(values: tuple, like: Tensor) -> Tensor:
    """Return constants with one trailing axis of length 1 per batch axis of `like` [*b]."""
    constant = like.new_tensor(values)
    return constant.reshape(*constant.shape, *(1,) * like.ndim)


def gyroscopic_coupling(vehicle: Vehicle) -> Tensor:
    """Return (Iy - Iz) / Ix and its cyclic companions, [3, *b]."""
    x, y, z = vehicle.inertia_kgm2.unbind(0)
    return torch.stack(((y - z) / x, (z - x) / y, (x - y) / z))


def gyroscopic(coupling: Tensor, rate: Tensor) -> Tensor:
    """Return the torque-free angular acceleration -I^-1 (rate x I rate), [3, *b] rad/s^2."""
    cyclic = torch.cat((rate, rate[:2]))
    return (cyclic[1:4] * cyclic[2:5]).mul_(coupling)


def turn(
    rotation: Tensor, rate: Tensor, torque: Tensor, coupling: Tensor, free: Tensor, dt_s: float
) -> tuple[Tensor, Tensor]:
    """Return attitude and body rate after `dt_s`: explicit midpoint, exponential map.

    `torque` [3, *b] is the step's mean angular acceleration from torque, `free` [3, *b] the
    gyroscopic one at its start, both rad/s^2. Second order.
    """
    middle = torch.add(rate, torque + free, alpha=0.5 * dt_s)
    end = torch.add(rate, gyroscopic(coupling, middle).add_(torque), alpha=dt_s)
    return so3.compose(rotation, so3.exp(middle.mul_(dt_s))), end


class RateLoop:
    """Proportional rate control with gyroscopic feed-forward, a mixer and per-motor limits.

    The torque commanded is I K (command - rate) + rate x I rate. The controller knows the vehicle's
    inertia but neither its scales nor its motor lag, so the loop's true gain is the torque scale
    times K. Where motors cannot give it all, yaw gives way first, as its motor strokes are the
    longest (Faessler et al. 2017, "Thrust Mixing, Saturation, and Body-Rate Control"); then each
    motor is clipped by itself.
    """

    per_acceleration: Tensor
    """Thrust of each motor per angular acceleration about each axis, [3, 4, *b]."""

    def __init__(self, vehicle: Vehicle) -> None:
        like = vehicle.mass_kg
        wrench = column(WRENCH_PER_THRUST, like)
        inverse = wrench / (wrench * wrench).sum(1, keepdim=True)
        self.per_acceleration = inverse[1:] * vehicle.inertia_kgm2[:, None]
        self.gain = column(RATE_GAIN_PER_S, like)
        self._roll, self._pitch = self.per_acceleration[0], self.per_acceleration[1]
        self._yaw = self.per_acceleration[2, 0]
        self._ceiling = column((MOTOR_THRUST_MAX_N,), like)
        self._spin = column(WRENCH_PER_THRUST[3], like).sign()

    def motor_commands(
        self, level: Tensor, target: Tensor, rate: Tensor, gyroscopic: Tensor
    ) -> Tensor:
        """Return the four motors' commands, [4, *b] N, each within its limits.

        `level` [*b] is a quarter of the collective command in N, `target` [3, *b] is `gain` times
        the rate command, `rate` [3, *b] the body rate and `gyroscopic` [3, *b] the angular
        acceleration that it causes by itself, rad/s^2.
        """
        acceleration = torch.addcmul(target, self.gain, rate, value=-1.0).sub_(gyroscopic)
        roll, pitch, yaw = acceleration.unbind(0)
        thrusts = torch.addcmul(level, self._roll, roll).addcmul_(self._pitch, pitch)
        thrusts = thrusts.clamp_(0.0, MOTOR_THRUST_MAX_N)
        room = torch.minimum(thrusts, self._ceiling - thrusts).amin(0)
        stroke = torch.clamp(self._yaw * yaw, -room, room)
        return thrusts.addcmul_(self._spin, stroke)


class TorchPlant(Plant):
    """Rigid body, rate loop, motors with lag and limits, linear drag and wind.

    One step of 2 ms is second order: motor lag and its mean over the step are exact, the body turns
    by the midpoint rule, and translation is Strang split into half a kick of thrust and gravity,
    exact drag, and the other half.

    One batch axis in float64 on the CPU is flown by the compiled kernel where there is one, which
    repeats these equations; everything else in torch.
    """

    def __init__(self, vehicle: Vehicle, dt_s: float = PLANT_DT_S) -> None:
        super().__init__(vehicle)
        like = vehicle.mass_kg
        self._dt_s = dt_s
        self._rate_limit = column(RATE_LIMIT_RADPS, like)
        self._loop = RateLoop(vehicle)
        # What is left of the gap to a constant command at a step's end, and on average over it.
        h = dt_s / vehicle.motor_time_constant_s
        self._left_end, self._left_mean = torch.exp(-h), -torch.expm1(-h) / h
        self._coupling = gyroscopic_coupling(vehicle)
        # Realised acceleration per newton of each motor, [4, 4, *b]: along body z in m/s^2, then
        # about the axes in rad/s^2. The scales multiply what is realised, not what is commanded.
        realised = (vehicle.thrust_scale / vehicle.mass_kg)[None]
        realised = torch.cat((realised, vehicle.torque_scale / vehicle.inertia_kgm2))
        self._acceleration = column(WRENCH_PER_THRUST, like) * realised[:, None]
        # The attitude in mid step is taken as the mean of both ends, which is second order. The
        # step below uses their sum; the halves that this leaves out are in these constants.
        self._acceleration[0] *= 0.5 * dt_s * 0.5
        # Part of the air-relative velocity that drag takes along each body axis.
        self._relaxed = -torch.expm1(vehicle.drag_kgps * (-dt_s / vehicle.mass_kg)) * 0.25
        self._gravity_kick = column((0.0, 0.0, -GRAVITY_MPS2 * 0.5 * dt_s), like)
        kernels = native.kernels_on(like.device)
        fits = like.ndim == 1 and like.dtype == torch.float64
        self._compiled = None
        if kernels is not None and fits and covered(self, TorchPlant):
            # Of the second motor: one motor tells all by symmetry.
            own, mixing = self._acceleration[:, 1].abs(), self._loop.per_acceleration[:, 1].abs()
            weights = torch.stack((self._left_end, self._left_mean))
            airframes = torch.cat((own, mixing, weights, self._coupling, self._relaxed))
            self._compiled = CompiledPlant(kernels, airframes, dt_s)

    def advance(self, plant_state: PlantState, command: Tensor, winds: Tensor) -> PlantState:
        """Advance as every plant does; with a kernel in one call."""
        if self._compiled is not None:
            return self._compiled.advance(plant_state, command, winds)
        level = 0.25 * command[0].clamp(0.0, COLLECTIVE_MAX_N)
        rate = torch.clamp(command[1:], -self._rate_limit, self._rate_limit)
        target = self._loop.gain * rate
        for wind_mps in winds.unbind(0):
            plant_state = self._step(plant_state, level, target, wind_mps)
        return plant_state

    def fly(
        self, plant_state: PlantState, command: Tensor, winds: Tensor, standing: Standing
    ) -> tuple[PlantState, Standing]:
        """Fly as every plant does; with a kernel in one call, contact checks among its steps."""
        if self._compiled is None:
            return super().fly(plant_state, command, winds, standing)
        return self._compiled.fly(plant_state, command, winds, standing)

    def _step(
        self, plant_state: PlantState, level: Tensor, target: Tensor, wind_mps: Tensor
    ) -> PlantState:
        state, dt_s = plant_state.state, self._dt_s
        free = gyroscopic(self._coupling, state.rate)
        commands = self._loop.motor_commands(level, target, state.rate, free)
        thrusts = torch.lerp(commands, plant_state.thrusts, self._left_end)
        mean = torch.lerp(commands, plant_state.thrusts, self._left_mean)
        kick_and_torque = (self._acceleration * mean).sum(1)

        rotation, rate = turn(
            state.rotation, state.rate, kick_and_torque[1:], self._coupling, free, dt_s
        )
        twice_middle = state.rotation + rotation
        kick = (twice_middle[:, 2] * kick_and_torque[0]).add_(self._gravity_kick)
        velocity = state.velocity + kick
        air = so3.rotate_back(twice_middle, wind_mps - velocity).mul_(self._relaxed)
        velocity = velocity.add_(so3.rotate(twice_middle, air)).add_(kick)
        position = torch.add(state.position, state.velocity + velocity, alpha=0.5 * dt_s)
        return PlantState(State(position, velocity, rotation, rate), thrusts)
