"""What may end a trial in flight: contact with the scene, looked for between the plant's steps."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import torch
from torch import Tensor

from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.state import State
from faultpath_quadrotor.vehicle import COLLISION_RADIUS_M, PLANT_RATE_HZ

CONTACT_EVERY = 5
"""Plant steps between contact checks: 10 ms, 3.4 cm at the planner's top speed."""


@dataclass(frozen=True)
class Progress:
    """Where each lane's trial stands, `[L]`; a lane that is no longer running stays as it ended."""

    running: Tensor
    crashed: Tensor
    succeeded: Tensor
    time_s: Tensor
    terminal_distance_m: Tensor
    min_clearance_m: Tensor

    def to(self, device: torch.device) -> Progress:
        """Return it on another device."""
        return Progress(*(getattr(self, field.name).to(device) for field in fields(self)))


@dataclass(frozen=True)
class Contact:
    """What each lane's vehicle may touch, and where its trial should end."""

    geometry: Geometry
    goal: Tensor
    """`[3, L]`, m."""
    every: int = CONTACT_EVERY
    """Plant steps between two looks."""

    @cached_property
    def solids(self) -> Tensor:
        """The prisms as the compiled check reads them, `[K, 10, L]`: `Solid` names the rows."""
        return self.geometry.numbers().transpose(0, 1).contiguous()

    def begin(self, state: State) -> Progress:
        """Return the progress of trials that start at `state`."""
        zero = torch.zeros_like(self.goal[0])
        none = torch.zeros_like(zero, dtype=torch.bool)
        return Progress(
            running=~none,
            crashed=none,
            succeeded=none,
            time_s=zero,
            terminal_distance_m=self._remaining(state),
            min_clearance_m=self._clearance(state),
        )

    def look(self, now: Progress, state: State, made: int) -> Progress:
        """Return the progress once `made` plant steps of the trials have led to `state`."""
        clearance = self._clearance(state)
        hit = now.running & (clearance <= 0)
        return replace(
            now,
            running=now.running & ~hit,
            crashed=now.crashed | hit,
            time_s=torch.where(now.running, made / PLANT_RATE_HZ, now.time_s),
            terminal_distance_m=torch.where(
                now.running, self._remaining(state), now.terminal_distance_m
            ),
            min_clearance_m=torch.where(
                now.running, torch.minimum(now.min_clearance_m, clearance), now.min_clearance_m
            ),
        )

    def _clearance(self, state: State) -> Tensor:
        return self.geometry.distance(state.position) - COLLISION_RADIUS_M

    def _remaining(self, state: State) -> Tensor:
        return (state.position - self.goal).norm(dim=0)
