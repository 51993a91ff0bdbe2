"""The predictor as a module of the loop: a query from commands to motion."""

import torch

from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Query
from faultpath_quadrotor.batching import lanes_of, scenes_first
from faultpath_quadrotor.predictors import Predictor
from faultpath_quadrotor.predictors.base import hover_thrust
from faultpath_quadrotor.predictors.predictor_inputs import ports, predictor_inputs, taking
from faultpath_quadrotor.predictors.rollout import Candidates, Predicted, rolling


class Prediction(Module):
    """Answers where commands lead, and gives the thrust that it believes holds the vehicle."""

    name, writes = "predictor", ("predicted_motion", "hover_thrust")

    def __init__(self, predictor: Predictor, device: torch.device) -> None:
        self._predictor = predictor
        self._device = device
        self.reads = ports(predictor.reads - {"history"})

    def begin(self, batch: Batch) -> Memory:
        """Return the lanes, and how the predictor is rolled out there."""
        return (
            lanes_of(batch, self._device),
            len(batch.scenes),
            rolling(self._predictor, self._device),
        )

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Take the predictor's readings in; its answers follow from them."""
        lanes, count, roll = memory
        known = predictor_inputs(self._predictor.reads, taking(inputs, lanes))
        hover = hover_thrust(known.delivered, "trim")[:, 0]

        def predict(candidates: Candidates) -> Predicted:
            rollouts = (
                roll(known.take(part.index), commands)
                for part, commands in zip(candidates.parts, candidates.commands, strict=True)
            )
            return Predicted(candidates.count, candidates.parts, tuple(rollouts))

        motion = Query(predict, Predicted.motion, Predicted.moved)
        return {"predicted_motion": motion, "hover_thrust": scenes_first(hover, count)}, memory
