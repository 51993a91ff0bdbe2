"""The only horizon loop: planner, training and probes all roll a predictor out here."""

from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath.quadrotor.predictors import Predictor, PredictorInputs
from faultpath.quadrotor.state import State


@dataclass(frozen=True)
class Rollout:
    """Predicted motion under candidate commands; `h = 0` is the end of the first interval."""

    positions: Tensor
    """`[3, S, H, K]`, metres, world frame: each scene's points lie together for the clearance."""
    velocities: Tensor
    """`[3, S, H, K]`, m/s, world frame."""
    final: State
    """State at the end of the horizon, batch `[S, K]`."""


def rollout(predictor: Predictor, inputs: PredictorInputs, commands: Tensor) -> Rollout:
    """Roll `commands` `[H, 4, S, K]` out from `inputs`, whose batch is `[S, 1]`."""
    horizon, _, scenes, candidates = commands.shape
    positions = commands.new_empty(3, scenes, horizon, candidates)
    velocities = torch.empty_like(positions)
    memory = predictor.begin(inputs)
    state = inputs.state
    for h in range(horizon):
        state, memory = predictor.step(state, commands[h], memory)
        positions[:, :, h] = state.position
        velocities[:, :, h] = state.velocity
    return Rollout(positions, velocities, state)
