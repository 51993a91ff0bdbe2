"""The quadrotor plant: a batch of vehicles, stepped at 500 Hz under commands held for 50 ms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.quadrotor import native
from faultpath.quadrotor.native.lending import covered
from faultpath.quadrotor.native.plant import CompiledPlant
from faultpath.quadrotor.plant import aerodynamics, motors, rigid_body
from faultpath.quadrotor.plant.rate_loop import RateLoop
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import COLLECTIVE_MAX_N, GRAVITY_MPS2, PLANT_DT_S, RATE_LIMIT_RADPS
from faultpath.quadrotor.vehicle_batch import Vehicle


@dataclass(frozen=True)
class PlantState:
    """What the plant carries from step to step."""

    state: State
    thrusts: Tensor
    """Thrust of each motor in N before the thrust scale, [4, *b], in the order of `motors`."""

    def take(self, index: Tensor) -> PlantState:
        """Return the lanes that `index` (long or bool, [n]) picks from the last batch axis."""
        return PlantState(self.state.take(index), self.thrusts[..., index])


class Plant:
    """Rigid body, rate loop, motors with lag and limits, linear drag and wind.

    Pure: states go in and new states come out. One step of 2 ms is second order: motor lag and
    its mean over the step are exact, the body turns by the midpoint rule, and translation is
    Strang split into half a kick of thrust and gravity, exact drag, and the other half.

    One batch axis in float64 on the CPU is flown by the compiled kernel where there is one, which
    repeats these equations; everything else in torch.
    """

    compiled: CompiledPlant | None
    """The kernel that flies these vehicles, if any."""

    def __init__(self, vehicle: Vehicle, dt_s: float = PLANT_DT_S) -> None:
        like = vehicle.mass_kg
        self._dt_s = dt_s
        self._hover_n = 0.25 * vehicle.hover_thrust_n
        self._rate_limit = motors.column(RATE_LIMIT_RADPS, like)
        self._loop = RateLoop(vehicle)
        self._left_end, self._left_mean = motors.lag_weights(vehicle.motor_time_constant_s, dt_s)
        self._coupling = rigid_body.gyroscopic_coupling(vehicle)
        # The attitude in mid step is taken as the mean of both ends, which is second order. The
        # step below uses their sum; the halves that this leaves out are in these constants.
        self._acceleration = motors.acceleration_per_thrust(vehicle)
        self._acceleration[0] *= 0.5 * dt_s * 0.5
        self._relaxed = aerodynamics.relaxation(vehicle, dt_s) * 0.25
        self._gravity_kick = motors.column((0.0, 0.0, -GRAVITY_MPS2 * 0.5 * dt_s), like)
        kernels = native.kernels_on(like.device)
        fits = like.ndim == 1 and like.dtype == torch.float64
        self.compiled = None
        if kernels is not None and fits and covered(self, Plant):
            self.compiled = CompiledPlant(kernels, self._airframes(), dt_s)

    def start(self, state: State) -> PlantState:
        """Return `state` with motors at hover trim."""
        return PlantState(state, self._hover_n.expand(4, *self._hover_n.shape).clone())

    def step(self, plant_state: PlantState, command: Tensor, wind_mps: Tensor) -> PlantState:
        """Advance 2 ms under `command` [4, *b] and `wind_mps` [3, *b] (world frame)."""
        return self.advance(plant_state, command, wind_mps[None])

    def advance(
        self,
        plant_state: PlantState,
        command: Tensor,
        winds: Tensor,
        observe: Callable[[int, State], None] | None = None,
    ) -> PlantState:
        """Advance under a held `command` [4, *b], one 2 ms step for each of `winds` [n, 3, *b].

        `observe`, if given, is called after each step with the number of steps made and the
        state, so that contact can be looked for between the ends. Commands beyond the vehicle's
        limits are clipped.
        """
        if observe is not None:
            for count, wind_mps in enumerate(winds.unbind(0), start=1):
                plant_state = self.step(plant_state, command, wind_mps)
                observe(count, plant_state.state)
            return plant_state
        if self.compiled is not None:
            flown = self.compiled.fly(plant_state.state, plant_state.thrusts, command, winds)
            return PlantState(*flown)
        level, target = self._limit(command)
        for wind_mps in winds.unbind(0):
            plant_state = self._step(plant_state, level, target, wind_mps)
        return plant_state

    def _airframes(self) -> Tensor:
        """Return what the kernel knows of each vehicle, `[15, b]`, rows as in `plant.hpp`."""
        own = self._acceleration[:, 1].abs()  # of the second motor: one motor tells all by symmetry
        mixing = self._loop.per_acceleration[:, 1].abs()
        weights = torch.stack((self._left_end, self._left_mean))
        return torch.cat((own, mixing, weights, self._coupling, self._relaxed))

    def _limit(self, command: Tensor) -> tuple[Tensor, Tensor]:
        level = 0.25 * command[0].clamp(0.0, COLLECTIVE_MAX_N)
        rate = torch.clamp(command[1:], -self._rate_limit, self._rate_limit)
        return level, self._loop.target(rate)

    def _step(self, now: PlantState, level: Tensor, target: Tensor, wind_mps: Tensor) -> PlantState:
        state, dt_s = now.state, self._dt_s
        free = rigid_body.gyroscopic(self._coupling, state.rate)
        commands = self._loop.motor_commands(level, target, state.rate, free)
        thrusts = motors.respond(now.thrusts, commands, self._left_end)
        mean = motors.respond(now.thrusts, commands, self._left_mean)
        kick_and_torque = (self._acceleration * mean).sum(1)

        rotation, rate = rigid_body.turn(
            state.rotation, state.rate, kick_and_torque[1:], self._coupling, free, dt_s
        )
        twice_middle = state.rotation + rotation
        kick = (twice_middle[:, 2] * kick_and_torque[0]).add_(self._gravity_kick)
        velocity = state.velocity + kick
        drag = aerodynamics.velocity_change(twice_middle, wind_mps - velocity, self._relaxed)
        velocity = velocity.add_(drag).add_(kick)
        position = torch.add(state.position, state.velocity + velocity, alpha=0.5 * dt_s)
        return PlantState(State(position, velocity, rotation, rate), thrusts)
