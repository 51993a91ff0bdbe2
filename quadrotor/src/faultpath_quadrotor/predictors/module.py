"""The predictor as modules of the loop: its queries, and its memory of the executed flight."""

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Batch, Memory, Outputs, Query
from faultpath_quadrotor.batching import Delivered, LaneModule
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.base import history, ports, predictor_inputs
from faultpath_quadrotor.predictors.rollout import Candidates, Predicted, Roll, rolling


class PredictorModule(LaneModule):
    """Answers where commands lead, and gives the thrust that it believes holds the vehicle."""

    name, writes = "predictor", ("predicted_motion", "hover_thrust")

    def __init__(self, predictor: Predictor, device: torch.device) -> None:
        super().__init__(device)
        self._predictor = predictor
        self.reads = ports(predictor.reads - {"history"})

    @override
    def begin(self, batch: Batch) -> Memory:
        # Built once a batch: a compiled rollout holds a copy of the weights that there are now.
        lanes, count, _ = super().begin(batch)
        return lanes, count, rolling(self._predictor, self._device)

    @override
    def compute(self, readings: Delivered, step: int, memory: Roll) -> tuple[Outputs, Roll]:
        known = predictor_inputs(self._predictor.reads, lambda *read: readings[read])

        def predict(candidates: Candidates) -> Predicted:
            rollouts = (
                memory(known.take(chunk.index), commands)
                for chunk, commands in zip(candidates.chunks, candidates.commands, strict=True)
            )
            return Predicted(candidates.count, candidates.chunks, tuple(rollouts))

        motion = Query(predict, Predicted.motion, Predicted.moved)
        return {"predicted_motion": motion, "hover_thrust": known.hover_thrust}, memory


STEPS = 12  # paper, Section IV-A

MOTION = ("velocity", "attitude", "body_rate")


class HistoryEncoder(LaneModule):
    """Encodes the last 12 intervals of every lane, once a step.

    It remembers them as delivered when they were new, the motion at the start of each and the
    command executed over it, and the latest motion.
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
    def compute(self, readings: Delivered, step: int, memory: Memory) -> tuple[Outputs, Memory]:
        motion = {name: readings[name, "history"].float() for name in MOTION}
        command = readings["action", "history"].float()
        if memory is None:
            intervals = ((motion, command),) * STEPS
        else:
            past, latest = memory
            intervals = (*past[1:], (latest, command))
        motions, commands = zip(*intervals, strict=True)

        def recalled(channel: str, place: str) -> Tensor:
            if channel == "mass" or place != "history":
                return readings[channel, place]
            if channel == "action":
                return torch.stack(commands, 1)
            return torch.stack([motion[channel] for motion in motions], motion[channel].ndim - 1)

        code = self._predictor.encode(history(self._predictor.reads, recalled))
        return {"history_encoding": code}, (intervals, motion)
