"""Plants as the world flies them, whatever integrates the motion, and the vehicles they fly."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
import torch
from torch import Tensor

from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.state import Batched, State
from faultpath_quadrotor.vehicle import (
    COLLISION_RADIUS_M,
    GRAVITY_MPS2,
    PLANT_RATE_HZ,
    VehicleParameters,
)


@dataclass(frozen=True)
class Vehicle(Batched):
    """A batch of vehicles as tensors; `*b` is the batch shape."""

    mass_kg: Tensor
    """[*b]"""
    thrust_scale: Tensor
    """Realised thrust over commanded, [*b]: acceleration is `thrust_scale * u / mass_kg`."""
    torque_scale: Tensor
    """Realised torque over commanded, [*b]."""
    inertia_kgm2: Tensor
    """Principal moments along the body axes, [3, *b]."""
    motor_time_constant_s: Tensor
    """[*b]"""
    drag_kgps: Tensor
    """Linear drag along the body axes, [3, *b]."""

    @classmethod
    def stack(cls, parameters: Sequence[VehicleParameters]) -> Vehicle:
        """Return the vehicles of a list as one batch, float64, in its order."""
        names = [field.name for field in fields(cls)]
        columns = (np.array([getattr(p, name) for p in parameters], np.float64) for name in names)
        return cls(*(torch.from_numpy(column.T.copy()) for column in columns))

    @property
    def hover_thrust_n(self) -> Tensor:
        """Collective thrust command that balances the weight, N, [*b]."""
        return self.mass_kg * GRAVITY_MPS2 / self.thrust_scale

    def hover_command(self) -> Tensor:
        """Return the command that holds a level vehicle at rest, [4, *b]."""
        thrust = self.hover_thrust_n
        return torch.cat((thrust[None], torch.zeros(3, *thrust.shape).to(thrust)))


CONTACT_EVERY = 5
"""Plant steps between contact checks: 10 ms, 3.4 cm at the planner's top speed."""


@dataclass(frozen=True)
class TrialProgress(Batched):
    """Where each lane's trial stands, `[L]`; a lane that is no longer running stays as it ended."""

    running: Tensor
    crashed: Tensor
    succeeded: Tensor
    time_s: Tensor
    terminal_distance_m: Tensor
    min_clearance_m: Tensor


@dataclass(frozen=True)
class Contact:
    """Solids that each lane's vehicle may touch, and the goal where its trial should end."""

    geometry: Geometry
    goal: Tensor
    """`[3, L]`, m."""

    @cached_property
    def solids(self) -> Tensor:
        """The prisms as the compiled check reads them, `[K, 10, L]`: `Solid` names the rows."""
        return self.geometry.numbers().transpose(0, 1).contiguous()

    def clearance(self, state: State) -> Tensor:
        """Return how far each vehicle is from what it would touch, `[L]`, m."""
        return self.geometry.distance(state.position) - COLLISION_RADIUS_M

    def remaining(self, state: State) -> Tensor:
        """Return how far each vehicle is from its goal, `[L]`, m."""
        return (state.position - self.goal).norm(dim=0)

    def begin(self, state: State) -> Standing:
        """Return where trials stand that start at `state`."""
        zero = torch.zeros_like(self.goal[0])
        none = torch.zeros_like(zero, dtype=torch.bool)
        progress = TrialProgress(
            running=~none,
            crashed=none,
            succeeded=none,
            time_s=zero,
            terminal_distance_m=self.remaining(state),
            min_clearance_m=self.clearance(state),
        )
        return Standing(self, progress, 0)


@dataclass(frozen=True)
class Standing:
    """Where trials stand after some plant steps, and what they may touch."""

    contact: Contact
    progress: TrialProgress
    steps: int

    def after(self, state: State, steps: int) -> Standing:
        """Return where they stand once so many more plant steps have led to `state`."""
        progress, clearance = self.progress, self.contact.clearance(state)
        running, steps = progress.running, self.steps + steps
        hit = running & (clearance <= 0)
        remaining = self.contact.remaining(state)
        least = torch.minimum(progress.min_clearance_m, clearance)
        looked = replace(
            progress,
            running=running & ~hit,
            crashed=progress.crashed | hit,
            time_s=torch.where(running, steps / PLANT_RATE_HZ, progress.time_s),
            terminal_distance_m=torch.where(running, remaining, progress.terminal_distance_m),
            min_clearance_m=torch.where(running, least, progress.min_clearance_m),
        )
        return Standing(self.contact, looked, steps)


@dataclass(frozen=True)
class PlantState(Batched):
    """State that a plant carries from step to step."""

    state: State
    thrusts: Tensor
    """Thrust of each motor in N before the thrust scale, [4, *b], in the order of `motors`."""

    @property
    def parts(self) -> tuple[Tensor, ...]:
        """The parts of the state, and the thrusts."""
        return *self.state.parts, self.thrusts


class Plant(ABC):
    """A batch of vehicles under commands: rigid bodies, rate loops, motors, drag and wind.

    Pure: states go in and new states come out. A lane's flight does not depend on the others, bit
    for bit, in batches of whole groups of lanes (`state.padded_lanes`).
    """

    mark: ClassVar[str] = ""
    """Text that tells this plant's trials from those of the reference plant, which has none."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._hover_n = 0.25 * vehicle.hover_thrust_n

    def start(self, state: State) -> PlantState:
        """Return `state` with motors at hover trim."""
        return PlantState(state, self._hover_n.expand(4, *self._hover_n.shape).clone())

    @abstractmethod
    def advance(self, plant_state: PlantState, command: Tensor, winds: Tensor) -> PlantState:
        """Advance under a held `command` [4, *b], one 2 ms step for each of `winds` [n, 3, *b].

        Winds are in the world frame, m/s. Commands beyond the vehicle's limits are clipped.
        """

    def fly(
        self, plant_state: PlantState, command: Tensor, winds: Tensor, standing: Standing
    ) -> tuple[PlantState, Standing]:
        """Advance as `advance` does, and look for contact on the way.

        A plant that has a faster way to the same states and progress overrides this.
        """
        for block in winds.split(CONTACT_EVERY):
            plant_state = self.advance(plant_state, command, block)
            standing = standing.after(plant_state.state, len(block))
        return plant_state, standing
