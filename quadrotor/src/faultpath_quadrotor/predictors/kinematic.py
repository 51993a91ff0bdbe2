"""The differentiable kinematic integrator: a double integrator with a rate-loop lag."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath_quadrotor import so3
from faultpath_quadrotor.predictors.base import Memory, Predictor, PredictorInputs
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import CONTROL_DT_S, GRAVITY_MPS2


class LinearDrag:
    """Force of the air on the vehicle, linear in the air's velocity relative to it."""

    def __init__(self, coefficients_kgps: Sequence[float]) -> None:
        self.coefficients_kgps = tuple(coefficients_kgps)
        # With equal coefficients the rotations cancel: c R R^T v = c v.
        self._isotropic = len(set(self.coefficients_kgps)) == 1

    def force(self, rotation: Tensor, air_velocity: Tensor) -> Tensor:
        """Return the force in the world frame, N, for `air_velocity` `[3, *batch]` (wind - v)."""
        if self._isotropic:
            return air_velocity * self.coefficients_kgps[0]
        body = so3.rotate_back(rotation, air_velocity)
        return so3.rotate(rotation, self._along_axes(body, torch.mul))

    def inverse(self, rotation: Tensor, force: Tensor) -> Tensor:
        """Return the air velocity that would cause `force` `[3, *batch]`, N."""
        if self._isotropic:
            return force / self.coefficients_kgps[0]
        body = so3.rotate_back(rotation, force)
        return so3.rotate(rotation, self._along_axes(body, torch.div))

    def _along_axes(self, body: Tensor, scale: Callable[[Tensor, float], Tensor]) -> Tensor:
        # Numbers, not a tensor: copying one to a device at every step would wait for the host.
        pairs = zip(body, self.coefficients_kgps, strict=True)
        return torch.stack([scale(component, coefficient) for component, coefficient in pairs])


RATE_LAG_S = 0.05
"""Time constant of the closed rate loop: the inverse of its gain of 20 1/s."""
KEEP = math.exp(-CONTROL_DT_S / RATE_LAG_S)
MEAN = RATE_LAG_S / CONTROL_DT_S * (1 - KEEP)
"""What is left of a rate error at the end of a step, and on average over it."""


@dataclass(frozen=True)
class Constants:
    """Constants of the horizon, batch `[S, 1]`."""

    thrust_gain: Tensor
    """T~/m~."""
    wind_acceleration: Tensor | None
    """`[3, S, 1]`, w/m~; `None` without a wind input."""
    inverse_mass: Tensor | None


@dataclass(frozen=True)
class Residual:
    """Acceleration that a model adds to the integrator's own, `[3, S, K]` each."""

    linear_mps2: Tensor
    """World frame."""
    angular_radps2: Tensor
    """Body frame."""


class KinematicIntegrator(Predictor):
    """DKI: thrust along the body axis, gravity, and body rates that follow with a first-order lag.

    The paper's DKI has no drag. With `drag` the same integrator also subtracts the nominal linear
    drag, so that wind and drag act through the air-relative velocity; that is the wind-aware
    analytic predictor. The wind term is R (c o R^T w)/m~ in both (paper, Section IV-A); without
    `wind` there is no such input.

    The rate lag is integrated exactly, the attitude by the exponential map of the mean rate, and
    the thrust direction is the mean of the interval's ends: second order in the step.
    """

    def __init__(
        self,
        drag: bool = False,
        wind: bool = True,
        drag_kgps: Sequence[float] | None = None,
    ) -> None:
        if drag and not wind:
            raise ValueError("drag acts through the air's velocity: it needs the wind input")
        if wind and drag_kgps is None:
            raise ValueError(
                "wind acts through the drag: give `drag_kgps`, the platform's three coefficients"
            )
        self.drag = drag
        self.reads = frozenset({"initial_state", "trim", "dynamics"})
        if wind:
            self.reads |= {"wind_map"}
        self.air = LinearDrag(drag_kgps or (0.0, 0.0, 0.0))

    def begin(self, inputs: PredictorInputs) -> Constants:
        """Return the constants of the horizon; the memory does not change after."""
        gain = inputs["thrust_scale", "dynamics"] / inputs["mass", "dynamics"]
        if "wind_map" not in self.reads:
            return Constants(gain, None, None)
        mass_kg = inputs["mass", "wind_map"]
        return Constants(
            thrust_gain=gain,
            wind_acceleration=inputs["wind", "wind_map"] / mass_kg,
            inverse_mass=1 / mass_kg,
        )

    def step(self, state: State, command: Tensor, memory: Memory) -> tuple[State, Memory]:
        """Advance one interval; see `Predictor.step`."""
        return self.advance(state, command, memory), memory

    def advance(
        self, state: State, command: Tensor, constants: Constants, residual: Residual | None = None
    ) -> State:
        """Advance one interval; a residual of zero changes no bit of the result."""
        dt = CONTROL_DT_S
        target = command[1:]
        lag = state.rate - target
        turn = torch.add(target, lag, alpha=MEAN).mul_(dt)
        rate = torch.add(target, lag, alpha=KEEP)
        if residual is not None:
            turn = torch.add(turn, residual.angular_radps2, alpha=0.5 * dt * dt)
            rate = torch.add(rate, residual.angular_radps2, alpha=dt)
        rotation = so3.compose(state.rotation, so3.exp(turn))

        gain = (0.5 * constants.thrust_gain) * command[0]
        acceleration = (state.rotation[:, 2] + rotation[:, 2]) * gain
        if constants.wind_acceleration is not None:
            air = constants.wind_acceleration  # the air's velocity over the mass
            if self.drag:
                assert constants.inverse_mass is not None
                air = torch.addcmul(air, state.velocity, constants.inverse_mass, value=-1)
            acceleration += self.air.force(state.rotation, air)
        acceleration[2] -= GRAVITY_MPS2
        if residual is not None:
            acceleration += residual.linear_mps2

        velocity = torch.add(state.velocity, acceleration, alpha=dt)
        position = torch.add(state.position, state.velocity + velocity, alpha=0.5 * dt)
        return State(position, velocity, rotation, rate)
