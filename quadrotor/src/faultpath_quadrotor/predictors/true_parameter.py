"""The true-parameter predictor: the vehicle's own inner loop and aerodynamics, stepped coarsely."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import so3
from faultpath_quadrotor.batching import Delivered
from faultpath_quadrotor.predictors.base import Memory, Physics, Predictor, PredictorInputs
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2, RATE_GAIN_PER_S

CODE = 32
"""Numbers of a history code, as the interface declares it."""
SUBSTEPS = 4
SUBSTEP_S = CONTROL_DT_S / SUBSTEPS
FOLLOWED = 4
"""Intervals of the history that are replayed: after four of 50 ms even the slowest motors of the
ranges, 0.08 s, have forgotten where they began but for a twelfth."""


@dataclass(frozen=True)
class _Memory:
    physics: Physics
    thrust_gain: Tensor
    inverse_mass: Tensor
    wind: Tensor
    stiffness: Tensor  # torque per rate error
    keep: Tensor  # share of a motor's lag left after a substep
    mean: Tensor  # its mean share over the substep
    thrust: Tensor  # lagged collective thrust, N
    torque: Tensor  # lagged body torque, N m


class TrueParameter(Predictor):
    """Rigid body, rate loop, motor lag and linear drag with the vehicle's true parameters.

    Mass and thrust scale still come from the calibration taps. It is not the plant: it has no
    mixer, no motor limits, and steps of 12.5 ms in a semi-implicit scheme (paper, Section IV-A:
    "integration is separate").

    It replays the commands that were executed over the last intervals, so that it knows the thrust
    and the torque that its motors hold.
    """

    reads = frozenset(
        {"initial_state", "trim", "dynamics", "wind_map", "physics", "history", "latent"}
    )

    @override
    def encode(self, history: Delivered) -> Tensor:
        """Return the last body rates and commands, `[32, *batch]`: what the replay starts from.

        The motors' parameters are read elsewhere, so the replay itself is in `begin`.
        """
        motion = (history["body_rate", "history"], history["action", "history"])
        past = torch.cat(motion)[:, -FOLLOWED:]
        code = past.flatten(0, 1)
        return torch.cat((code, code.new_zeros(CODE - len(code), *code.shape[1:])))

    def begin(self, inputs: PredictorInputs) -> Memory:
        """Return constants, and motors as they are now."""
        physics = Physics.of(inputs["physics", "physics"])
        lag = physics.motor_time_constant_s / SUBSTEP_S
        keep = torch.exp(-1 / lag)
        start = _Memory(
            physics=physics,
            thrust_gain=inputs["thrust_scale", "dynamics"] / inputs["mass", "dynamics"],
            inverse_mass=1 / inputs["mass", "wind_map"],
            wind=inputs["wind", "wind_map"],
            stiffness=torch.stack(
                [i * k for i, k in zip(physics.inertia_kgm2, RATE_GAIN_PER_S, strict=True)]
            ),
            keep=keep,
            mean=lag * (1 - keep),
            thrust=physics.collective_thrust_n,
            torque=torch.zeros_like(inputs.state.rate),
        )
        return self._followed(start, inputs["history_code", "latent"])

    def _followed(self, start: _Memory, code: Tensor) -> _Memory:
        """Return the memory with motors that have followed the last commands.

        They start as if the oldest command had been held for long.
        """
        past = code[: 7 * FOLLOWED].unflatten(0, (7, FOLLOWED)).unbind(1)
        thrust, torque = past[0][3], start.torque
        for interval in past:
            rate, command = interval[:3], interval[3:]
            for _ in range(SUBSTEPS):
                thrust = torch.lerp(command[0], thrust, start.keep)
                rate, torque = self._turn(rate, command[1:], torque, start)
        return replace(start, thrust=thrust, torque=torque)

    def step(self, state: State, command: Tensor, memory: _Memory) -> tuple[State, Memory]:
        """Advance one interval; see `Predictor.step`."""
        thrust, torque = memory.thrust, memory.torque
        for _ in range(SUBSTEPS):
            lag = thrust - command[0]
            average = torch.addcmul(command[0], lag, memory.mean)  # over the substep: exact
            thrust = torch.addcmul(command[0], lag, memory.keep)
            state, torque = self._substep(state, command[1:], average, torque, memory)
        return state, replace(memory, thrust=thrust, torque=torque)

    def _substep(
        self, state: State, target: Tensor, thrust: Tensor, torque: Tensor, memory: _Memory
    ) -> tuple[State, Tensor]:
        h = SUBSTEP_S
        physics = memory.physics
        rate, torque = self._turn(state.rate, target, torque, memory)
        rotation = so3.compose(state.rotation, so3.exp(0.5 * h * (state.rate + rate)))

        acceleration = rotation[:, 2] * (memory.thrust_gain * thrust)
        body = so3.rotate_back(rotation, memory.wind - state.velocity)
        air = so3.rotate(rotation, physics.drag_kgps * body)
        acceleration = torch.addcmul(acceleration, air, memory.inverse_mass)
        acceleration[2] -= GRAVITY_MPS2
        velocity = torch.add(state.velocity, acceleration, alpha=h)
        position = torch.add(state.position, state.velocity + velocity, alpha=0.5 * h)
        return State(position, velocity, rotation, rate), torque

    def _turn(
        self, rate: Tensor, target: Tensor, torque: Tensor, memory: _Memory
    ) -> tuple[Tensor, Tensor]:
        inertia = memory.physics.inertia_kgm2
        gyroscopic = torch.linalg.cross(rate, inertia * rate, dim=0)
        demand = memory.stiffness * (target - rate) + gyroscopic
        torque = torch.lerp(demand, torque, memory.keep)
        turned = memory.physics.torque_scale * torque - gyroscopic
        return rate + SUBSTEP_S * turned / inertia, torque
