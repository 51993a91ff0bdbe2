"""What recovers a channel that no sensor supplies."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from torch import Tensor

from faultpath.quadrotor.predictors import Calibration

Memory = Any


@dataclass(frozen=True)
class Sensed:
    """What the module's taps delivered at this step, batch `[*batch]`."""

    velocity_mps: Tensor
    """World frame, `[3, *batch]`."""
    rotation: Tensor
    """Body to world, `[3, 3, *batch]`."""
    executed: Tensor
    """Command executed over the interval that has just ended, `[4, *batch]`."""
    nominal: Calibration
    """Calibration of the nominal dynamics."""
    wind_map_mass_kg: Tensor
    """Mass that the wind map is inverted with, `[*batch]`."""


class Reconstruction(ABC):
    """Estimates the current wind from completed intervals; it never sees a candidate action."""

    @abstractmethod
    def begin(self, first: Sensed) -> Memory:
        """Return the memory at the start of an episode, from the first readings."""

    @abstractmethod
    def update(self, memory: Memory, sensed: Sensed) -> Memory:
        """Take in the interval that ended with `sensed`."""

    @abstractmethod
    def wind(self, memory: Memory) -> Tensor:
        """Return the current estimate `[3, *batch]`, m/s, world frame."""
