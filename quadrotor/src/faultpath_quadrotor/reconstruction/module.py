"""Wind reconstruction as a module of the loop."""

from typing import Any

import torch
from typing_extensions import override

from faultpath.loop import Outputs, Port
from faultpath_quadrotor.batching import Delivered, LaneModule
from faultpath_quadrotor.reconstruction import Reconstruction


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
