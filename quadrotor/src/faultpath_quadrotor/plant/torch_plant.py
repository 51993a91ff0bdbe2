"""The reference plant in torch: a batch of vehicles, stepped at 500 Hz under held commands."""

from __future__ import annotations

import torch
from torch import Tensor

from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import covered
from faultpath_quadrotor.plant import motors
from faultpath_quadrotor.plant.compiled import CompiledPlant
from faultpath_quadrotor.plant.motors import RateLoop
from faultpath_quadrotor.plant.protocol import Plant, PlantState, Standing
from faultpath_quadrotor.plant.vehicle_batch import Vehicle
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import COLLECTIVE_MAX_N, GRAVITY_MPS2, PLANT_DT_S, RATE_LIMIT_RADPS


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
        self._rate_limit = motors.column(RATE_LIMIT_RADPS, like)
        self._loop = RateLoop(vehicle)
        self._left_end, self._left_mean = motors.lag_weights(vehicle.motor_time_constant_s, dt_s)
        self._coupling = motors.gyroscopic_coupling(vehicle)
        # The attitude in mid step is taken as the mean of both ends, which is second order. The
        # step below uses their sum; the halves that this leaves out are in these constants.
        self._acceleration = motors.acceleration_per_thrust(vehicle)
        self._acceleration[0] *= 0.5 * dt_s * 0.5
        self._relaxed = motors.relaxation(vehicle, dt_s) * 0.25
        self._gravity_kick = motors.column((0.0, 0.0, -GRAVITY_MPS2 * 0.5 * dt_s), like)
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
        target = self._loop.target(rate)
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
        free = motors.gyroscopic(self._coupling, state.rate)
        commands = self._loop.motor_commands(level, target, state.rate, free)
        thrusts = torch.lerp(commands, plant_state.thrusts, self._left_end)
        mean = torch.lerp(commands, plant_state.thrusts, self._left_mean)
        kick_and_torque = (self._acceleration * mean).sum(1)

        rotation, rate = motors.turn(
            state.rotation, state.rate, kick_and_torque[1:], self._coupling, free, dt_s
        )
        twice_middle = state.rotation + rotation
        kick = (twice_middle[:, 2] * kick_and_torque[0]).add_(self._gravity_kick)
        velocity = state.velocity + kick
        drag = motors.velocity_change(twice_middle, wind_mps - velocity, self._relaxed)
        velocity = velocity.add_(drag).add_(kick)
        position = torch.add(state.position, state.velocity + velocity, alpha=0.5 * dt_s)
        return PlantState(State(position, velocity, rotation, rate), thrusts)
