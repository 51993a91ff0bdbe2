"""The predictor as a module of the loop: a query from commands to motion."""

import torch
from typing_extensions import override

from faultpath.loop import Batch, Memory, Outputs, Query
from faultpath_quadrotor.batching import Delivered, LaneModule
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.base import hover_thrust
from faultpath_quadrotor.predictors.predictor_inputs import ports, predictor_inputs, single
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
        known = predictor_inputs(self._predictor.reads, single(readings))
        hover = hover_thrust(known.delivered, "trim")[:, 0]

        def predict(candidates: Candidates) -> Predicted:
            rollouts = (
                memory(known.take(chunk.index), commands)
                for chunk, commands in zip(candidates.chunks, candidates.commands, strict=True)
            )
            return Predicted(candidates.count, candidates.chunks, tuple(rollouts))

        motion = Query(predict, Predicted.motion, Predicted.moved)
        return {"predicted_motion": motion, "hover_thrust": hover}, memory
