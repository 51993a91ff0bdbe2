"""The differentiable kinematic integrator: a double integrator with a rate-loop lag."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.quadrotor import so3
from faultpath.quadrotor.predictors.base import Memory, Predictor, PredictorInputs
from faultpath.quadrotor.predictors.drag import LinearDrag
from faultpath.quadrotor.state import State
from faultpath.quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2

RATE_LAG_S = 0.05
"""Time constant of the closed rate loop: the inverse of its gain of 20 1/s."""


@dataclass(frozen=True)
class _Constants:
    thrust_gain: Tensor  # T~/m~, `[S, 1]`
    wind_acceleration: Tensor  # `[3, S, 1]` if isotropic drag makes it constant, else the wind
    inverse_mass: Tensor


class KinematicIntegrator(Predictor):
    """DKI: thrust along the body axis, gravity, and body rates that follow with a first-order lag.

    The paper's DKI has no drag. With `drag` the same integrator also subtracts the nominal linear
    drag, so that wind and drag act through the air-relative velocity; that is the wind-aware
    analytic predictor. The wind term is R (c o R^T w)/m~ in both (paper, Section IV-A).

    The rate lag is integrated exactly, the attitude by the exponential map of the mean rate, and
    the thrust direction is the mean of the interval's ends: second order in the step.
    """

    def __init__(self, drag: bool = False, dt_s: float = CONTROL_DT_S) -> None:
        self.drag = drag
        self._air = LinearDrag()
        self._dt = dt_s
        self._keep = math.exp(-dt_s / RATE_LAG_S)
        self._mean = RATE_LAG_S / dt_s * (1 - self._keep)

    def begin(self, inputs: PredictorInputs) -> Memory:
        """Return the constants of the horizon; the memory does not change after."""
        return _Constants(
            thrust_gain=inputs.dynamics.thrust_scale / inputs.dynamics.mass_kg,
            wind_acceleration=inputs.wind_mps / inputs.wind_map_mass_kg,
            inverse_mass=1 / inputs.wind_map_mass_kg,
        )

    def step(self, state: State, command: Tensor, memory: Memory) -> tuple[State, Memory]:
        """Advance one interval; see `Predictor.step`."""
        dt = self._dt
        constants: _Constants = memory
        target = command[1:]
        lag = state.rate - target
        turn = torch.add(target, lag, alpha=self._mean).mul_(dt)
        rotation = so3.compose(state.rotation, so3.exp(turn))

        gain = (0.5 * constants.thrust_gain) * command[0]
        acceleration = (state.rotation[:, 2] + rotation[:, 2]) * gain
        # Acceleration of the air: the wind term alone, or wind and drag together.
        air = constants.wind_acceleration
        if self.drag:
            air = torch.addcmul(air, state.velocity, constants.inverse_mass, value=-1)
        acceleration += self._air.force(state.rotation, air)
        acceleration[2] -= GRAVITY_MPS2

        velocity = torch.add(state.velocity, acceleration, alpha=dt)
        position = torch.add(state.position, state.velocity + velocity, alpha=0.5 * dt)
        rate = torch.add(target, lag, alpha=self._keep)
        return State(position, velocity, rotation, rate), memory
