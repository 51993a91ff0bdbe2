"""What the planner, training and probes need of a predictor."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import torch
from torch import Tensor

from faultpath.quadrotor.state import State

Memory = Any
"""What a predictor carries from step to step; opaque to everybody else."""


@dataclass(frozen=True)
class Calibration:
    """Supplied mass and thrust scale, each `[*batch]`: the values that a tap delivered."""

    mass_kg: Tensor
    thrust_scale: Tensor

    def hover_thrust(self, gravity: float) -> Tensor:
        """Collective thrust command that holds the vehicle if the calibration is right, N."""
        return self.mass_kg * gravity / self.thrust_scale


@dataclass(frozen=True)
class Physics:
    """Physical parameters that only the true-parameter predictor may read, all `[.., *batch]`."""

    inertia_kgm2: Tensor
    torque_scale: Tensor
    motor_time_constant_s: Tensor
    drag_kgps: Tensor
    collective_thrust_n: Tensor
    """Thrust that the motors hold at this moment, before the thrust scale, N."""


@dataclass(frozen=True)
class PredictorInputs:
    """Everything a predictor is told at a replan, as its taps delivered it; batch `[S, 1]`.

    The three places where calibration enters are separate taps, so each has its own field.
    """

    state: State
    dynamics: Calibration
    trim: Calibration
    wind_map_mass_kg: Tensor
    wind_mps: Tensor
    physics: Physics | None = None

    def take(self, scenes: Sequence[int]) -> "PredictorInputs":
        """Return the inputs of some scenes, in the order given."""
        index = torch.as_tensor(scenes)

        def pick(value: Tensor) -> Tensor:
            return value.index_select(-2, index)

        return PredictorInputs(
            state=_each(self.state, pick),
            dynamics=_each(self.dynamics, pick),
            trim=_each(self.trim, pick),
            wind_map_mass_kg=pick(self.wind_map_mass_kg),
            wind_mps=pick(self.wind_mps),
            physics=None if self.physics is None else _each(self.physics, pick),
        )


_Parts = TypeVar("_Parts", State, Calibration, Physics)


def _each(parts: _Parts, change: Callable[[Tensor], Tensor]) -> _Parts:
    return type(parts)(**{f.name: change(getattr(parts, f.name)) for f in fields(parts)})


class Predictor(ABC):
    """Rolls candidate commands forward at the control rate.

    `begin` is called once a replan, `step` once a horizon step. Batches are `[S, K]`: scenes and
    candidates.
    """

    @abstractmethod
    def begin(self, inputs: PredictorInputs) -> Memory:
        """Prepare what stays the same over the horizon and the initial memory."""

    @abstractmethod
    def step(self, state: State, command: Tensor, memory: Memory) -> tuple[State, Memory]:
        """Advance one control interval under `command` `[4, S, K]`."""
