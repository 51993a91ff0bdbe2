"""Wind reconstruction as a module of the loop."""

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port
from faultpath_quadrotor.batching import lanes_last, lanes_of, scenes_first
from faultpath_quadrotor.reconstruction import Reconstruction


@dataclass(frozen=True)
class _Known:
    lanes: Tensor
    count: int
    memory: Any = None
    """Memory of the reconstruction; `None` before the first step."""


class WindReconstruction(Module):
    """Turns completed intervals into the wind that the predictor assumes."""

    name, writes = "reconstruction", ("reconstructed_wind",)

    def __init__(self, reconstruction: Reconstruction, device: torch.device) -> None:
        self._reconstruction = reconstruction
        self._device = device
        self.reads_past = frozenset(
            Port(*read) for read in reconstruction.reads if read[0] == "action"
        )
        self.reads = frozenset(Port(*read) for read in reconstruction.reads) - self.reads_past

    def begin(self, batch: Batch) -> Memory:
        """Return a memory without an interval."""
        return _Known(lanes_of(batch, self._device), len(batch.scenes))

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Take the step's readings in and return the wind, `[B, 3]`, m/s."""
        known: _Known = memory
        delivered = {read: lanes_last(value, known.lanes) for read, value in inputs.items()}
        if known.memory is None:
            inside = self._reconstruction.begin(delivered)
        else:
            inside = self._reconstruction.update(known.memory, delivered)
        wind = scenes_first(self._reconstruction.wind(inside), known.count)
        return {"reconstructed_wind": wind}, _Known(known.lanes, known.count, inside)
