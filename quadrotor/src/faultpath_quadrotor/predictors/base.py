"""Predictors as the planner, training and probes use them."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import torch
from torch import Tensor

from faultpath.plugin.system import SystemMistake
from faultpath_quadrotor.batching import Delivered, Read
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import GRAVITY_MPS2

Memory = Any
"""State that a predictor carries from step to step; opaque to everybody else."""


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
class PredictorInputs:
    """Everything a predictor reads at a replan, as its taps delivered it; batch `[S, 1]`."""

    state: State
    """State at `initial_state`; its attitudes are rotations."""
    delivered: Delivered
    """Readings by channel and place, at the other places where the predictor reads now."""

    def __getitem__(self, read: Read) -> Tensor:
        """Return what a tap delivered; `SystemMistake` where the predictor does not read."""
        if read not in self.delivered:
            channel, place = read
            raise SystemMistake(
                f"the predictor asks for {channel} at {place!r} and does not read there: add "
                f"{place!r} to its reads"
            )
        return self.delivered[read]

    def take(self, scenes: Sequence[int] | Tensor) -> "PredictorInputs":
        """Return the inputs of some scenes, in the order given."""
        index = torch.as_tensor(scenes)
        return PredictorInputs(
            self.state.map(lambda part: part.index_select(-2, index)),
            {read: value.index_select(-2, index) for read, value in self.delivered.items()},
        )


@dataclass(frozen=True)
class Rollout:
    """Predicted motion under candidate commands; `h = 0` is the end of the first interval."""

    positions: Tensor
    """`[3, S, H, K]`, metres, world frame: each scene's points lie together for the clearance."""
    velocities: Tensor
    """`[3, S, H, K]`, m/s, world frame."""
    final: State
    """State at the end of the horizon, batch `[S, K]`."""


def hover_thrust(delivered: Delivered, place: str) -> Tensor:
    """Return the collective thrust that holds the vehicle if a place's calibration is right, N."""
    return delivered["mass", place] * GRAVITY_MPS2 / delivered["thrust_scale", place]


class Predictor(ABC):
    """Rolls candidate commands forward at the control rate.

    `begin` is called once a replan, `step` once a horizon step. Batches are `[S, K]`: scenes and
    candidates.
    """

    reads: frozenset[str]
    """Places at which it reads its channels: its readers in the interface."""
    data_files: Sequence[str | PathLike[str]] | None = None
    """Files that a user's own predictor reads, of every seed, such as weights."""

    def encode(self, history: Delivered) -> Tensor | None:
        """Return the history code `[32, *batch]`, once a replan; `None` without a memory.

        `history` holds the last intervals, oldest first, as the taps of the places `history` and
        `features` delivered them: motion in the world frame at the start of each, velocity
        `[3, T, *batch]` in m/s, attitude `[3, 3, T, *batch]`, body rate `[3, T, *batch]` in rad/s;
        the action executed over each, `[4, T, *batch]` in N and rad/s; calibration `[*batch]`.
        """
        del history
        return None

    @abstractmethod
    def begin(self, inputs: PredictorInputs) -> Memory:
        """Prepare what stays the same over the horizon and the initial memory."""

    @abstractmethod
    def step(self, state: State, command: Tensor, memory: Memory) -> tuple[State, Memory]:
        """Advance one control interval under `command` `[4, S, K]`."""
