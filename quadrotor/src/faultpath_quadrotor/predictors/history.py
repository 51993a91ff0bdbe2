"""Memory of the executed flight for learned predictors: its last intervals, encoded."""

from dataclasses import dataclass

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Outputs
from faultpath_quadrotor.batching import Delivered, LaneModule
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.predictor_inputs import history, ports, single

STEPS = 12  # paper, Section IV-A

MOTION = ("velocity", "attitude", "body_rate")


@dataclass(frozen=True)
class _Past:
    """The last intervals of every lane, as delivered when they were new."""

    intervals: tuple[tuple[dict[str, Tensor], Tensor], ...]
    """Motion at the start of each, and the command executed over it."""
    latest: dict[str, Tensor]


class HistoryEncoder(LaneModule):
    """Encodes the last 12 intervals of every lane, once a step.

    Before the flight the vehicle hovered where it is first seen, under the command that was
    executed then. The supplied mass normalises the whole record anew at each step.
    """

    name, writes = "predictor", ("history_encoding",)

    def __init__(self, predictor: Predictor, device: torch.device) -> None:
        super().__init__(device)
        self._predictor = predictor
        reads = ports({"history", "features"} & predictor.reads)
        self.reads_past = frozenset(port for port in reads if port.channel == "action")
        self.reads = reads - self.reads_past

    @override
    def compute(
        self, readings: Delivered, step: int, memory: _Past | None
    ) -> tuple[Outputs, _Past]:
        take = single(readings)
        motion = {name: take(name, "history") for name in MOTION}
        command = take("action", "history")
        if memory is None:
            intervals = ((motion, command),) * STEPS
        else:
            intervals = (*memory.intervals[1:], (memory.latest, command))
        motions, commands = zip(*intervals, strict=True)

        def recalled(channel: str, place: str) -> Tensor:
            if channel == "mass" or place != "history":
                return take(channel, place)
            if channel == "action":
                return torch.stack(commands, 1)
            return torch.stack([motion[channel] for motion in motions], motion[channel].ndim - 1)

        code = self._predictor.encode(history(self._predictor.reads, recalled))
        return {"history_encoding": code}, _Past(intervals, motion)
