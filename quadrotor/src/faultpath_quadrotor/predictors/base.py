"""What the planner, training and probes need of a predictor."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from os import PathLike
from typing import Any, TypeVar

import torch
from torch import Tensor

from faultpath_quadrotor.state import State

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

    @classmethod
    def of(cls, reading: Tensor) -> "Physics":
        """Return the parameters in a reading `[9, *batch]` of the channel `physics`."""
        return cls(reading[0:3], reading[3], reading[4], reading[5:8], reading[8])

    def reading(self) -> Tensor:
        """Return them as the channel `physics` carries them, `[9, *batch]`."""
        torque, lag, thrust = (
            part[None]
            for part in (self.torque_scale, self.motor_time_constant_s, self.collective_thrust_n)
        )
        return torch.cat((self.inertia_kgm2, torque, lag, self.drag_kgps, thrust))


@dataclass(frozen=True)
class History:
    """The last intervals as the predictor's taps delivered them, oldest first, batch `[*batch]`."""

    velocity_mps: Tensor
    """World frame, at the start of each interval, `[3, T, *batch]`."""
    rotation: Tensor
    """Body to world, `[3, 3, T, *batch]`."""
    rate_radps: Tensor
    """Body frame, `[3, T, *batch]`."""
    commands: Tensor
    """Executed over each interval, `[4, T, *batch]`, N and rad/s."""
    mass_kg: Tensor
    """Mass that normalises the thrust, `[*batch]`."""
    conditioning: Calibration | None = None
    """Calibration that is appended to the features, where a predictor has it there."""


@dataclass(frozen=True)
class PredictorInputs:
    """Everything a predictor is told at a replan, as its taps delivered it; batch `[S, 1]`.

    Every place where a channel enters is a tap of its own, so each has its own field. A field that
    a predictor does not read (`Predictor.reads`) is `None`.
    """

    state: State
    trim: Calibration
    """Where the planner's candidates are centred."""
    dynamics: Calibration | None = None
    wind_map_mass_kg: Tensor | None = None
    wind_mps: Tensor | None = None
    physics: Physics | None = None
    thrust_mass_kg: Tensor | None = None
    """Mass that normalises the thrust of the candidates."""
    conditioning: Calibration | None = None
    """Calibration that is appended to the features."""
    code: Tensor | None = None
    """History code, `[32, S, 1]`."""

    def take(self, scenes: Sequence[int] | Tensor) -> "PredictorInputs":
        """Return the inputs of some scenes, in the order given."""
        index = torch.as_tensor(scenes)

        def pick(value: Tensor) -> Tensor:
            return value.index_select(-2, index)

        return _each(self, pick)


_Parts = TypeVar("_Parts", State, Calibration, Physics, PredictorInputs)


def _each(parts: _Parts, change: Callable[[Tensor], Tensor]) -> _Parts:
    """Change every tensor of nested parts; what is `None` stays so."""

    def turn(value: Any) -> Any:
        if value is None:
            return None
        return change(value) if isinstance(value, Tensor) else _each(value, change)

    return type(parts)(**{f.name: turn(getattr(parts, f.name)) for f in fields(parts)})


class Predictor(ABC):
    """Rolls candidate commands forward at the control rate.

    `begin` is called once a replan, `step` once a horizon step. Batches are `[S, K]`: scenes and
    candidates.
    """

    reads: frozenset[str]
    """Places at which it reads its channels: its consumers in the interface."""
    data_files: Sequence[str | PathLike[str]] | None = None
    """Of one that a user brings: the files that it reads, of every seed, such as weights."""

    def consumers(self, module: str = "predictor") -> frozenset[str]:
        """Return the names `module.place` under which the interface lists its places."""
        return frozenset(f"{module}.{place}" for place in self.reads)

    def encode(self, history: History) -> Tensor | None:
        """Return the history code `[32, *batch]`, once a replan; `None` without a memory."""
        del history
        return None

    @abstractmethod
    def begin(self, inputs: PredictorInputs) -> Memory:
        """Prepare what stays the same over the horizon and the initial memory."""

    @abstractmethod
    def step(self, state: State, command: Tensor, memory: Memory) -> tuple[State, Memory]:
        """Advance one control interval under `command` `[4, S, K]`."""
