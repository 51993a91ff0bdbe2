"""What a plant is to the world, whatever integrates it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from torch import Tensor

from faultpath_quadrotor.plant.contact import Contact, Progress
from faultpath_quadrotor.plant.vehicle_batch import Vehicle
from faultpath_quadrotor.state import State


@dataclass(frozen=True)
class PlantState:
    """What a plant carries from step to step."""

    state: State
    thrusts: Tensor
    """Thrust of each motor in N before the thrust scale, [4, *b], in the order of `motors`."""

    def take(self, index: Tensor) -> PlantState:
        """Return the lanes that `index` (long or bool, [n]) picks from the last batch axis."""
        return PlantState(self.state.take(index), self.thrusts[..., index])


class Plant(ABC):
    """A batch of vehicles under commands: rigid bodies, rate loops, motors, drag and wind.

    Pure: states go in and new states come out. A lane's flight is the same in any company, bit for
    bit, in batches of whole groups of lanes (`state.padded_lanes`).
    """

    mark: ClassVar[str] = ""
    """What tells this plant's trials from those of the reference plant, which has none."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._hover_n = 0.25 * vehicle.hover_thrust_n

    def start(self, state: State) -> PlantState:
        """Return `state` with motors at hover trim."""
        return PlantState(state, self._hover_n.expand(4, *self._hover_n.shape).clone())

    @abstractmethod
    def advance(self, now: PlantState, command: Tensor, winds: Tensor) -> PlantState:
        """Advance under a held `command` [4, *b], one 2 ms step for each of `winds` [n, 3, *b].

        Winds are in the world frame, m/s. Commands beyond the vehicle's limits are clipped.
        """

    def fly(
        self,
        now: PlantState,
        command: Tensor,
        winds: Tensor,
        contact: Contact,
        progress: Progress,
        made: int,
    ) -> tuple[PlantState, Progress]:
        """Advance as `advance` does, and look for contact on the way.

        `made` plant steps of the trials came before. A plant that has a faster way to the same
        states and progress overrides this.
        """
        for block in winds.split(contact.every):
            now = self.advance(now, command, block)
            made += len(block)
            progress = contact.look(progress, now.state, made)
        return now, progress
