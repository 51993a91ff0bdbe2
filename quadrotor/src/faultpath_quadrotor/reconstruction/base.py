"""Reconstructions of a channel that no sensor supplies, and the loop's module that runs one."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from os import PathLike
from typing import Any, TypeAlias

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Outputs, Port
from faultpath_quadrotor.batching import Delivered, LaneModule, Read

Memory: TypeAlias = Any
"""State that a reconstruction carries from step to step; opaque to everybody else."""


class Reconstruction(ABC):
    """A wind estimator: estimates the current wind from completed intervals.

    It never sees a candidate action. The vehicle's own state comes from an `Estimator`.

    `reads` is all that it may know. The caller takes exactly these from the taps, so a variant's
    readers follow from it, and an undeclared read has no entry. The same channel at two places is
    two reads, because a fault may reach only one of them.

    The channel `action` holds the command executed over the interval that has just ended, N and
    rad/s; at `begin` the one under which the vehicle hovered before its flight.
    """

    reads: frozenset[Read]
    data_files: Sequence[str | PathLike[str]] | None = None
    """Files that a user's own reconstruction reads, of every seed, such as weights."""

    @abstractmethod
    def begin(self, delivered: Delivered) -> Memory:
        """Return the memory at the start of an episode, from the first readings."""

    @abstractmethod
    def update(self, memory: Memory, delivered: Delivered) -> Memory:
        """Take in the interval that ended with `delivered`."""

    @abstractmethod
    def wind(self, memory: Memory) -> Tensor:
        """Return the current estimate `[3, *batch]`, m/s, world frame."""


class WindModule(LaneModule):
    """Turns completed intervals into the wind that the predictor assumes."""

    name, writes = "reconstruction", ("reconstructed_wind",)

    def __init__(self, reconstruction: Reconstruction, device: torch.device) -> None:
        super().__init__(device)
        self._reconstruction = reconstruction
        reads = frozenset(Port(*read) for read in reconstruction.reads)
        self.reads_past = frozenset(port for port in reads if port.channel == "action")
        self.reads = reads - self.reads_past

    @override
    def compute(self, readings: Delivered, step: int, memory: Any) -> tuple[Outputs, Any]:
        model = self._reconstruction
        known = model.begin(readings) if memory is None else model.update(memory, readings)
        return {"reconstructed_wind": model.wind(known)}, known
