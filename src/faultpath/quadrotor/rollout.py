"""The only horizon loop: planner, training and probes all roll a predictor out here."""

from collections.abc import Iterator
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


def unroll(predictor: Predictor, inputs: PredictorInputs, commands: Tensor) -> Iterator[State]:
    """Yield the state after each of `commands` `[H, 4, S, K]`, from `inputs` of batch `[S, 1]`.

    Each prediction is the input to the next step; differentiable where the predictor is.
    """
    memory = predictor.begin(inputs)
    state = inputs.state
    for command in commands:
        state, memory = predictor.step(state, command, memory)
        yield state


def rollout(predictor: Predictor, inputs: PredictorInputs, commands: Tensor) -> Rollout:
    """Roll `commands` `[H, 4, S, K]` out from `inputs`, whose batch is `[S, 1]`."""
    horizon, _, scenes, candidates = commands.shape
    positions = commands.new_empty(3, scenes, horizon, candidates)
    velocities = torch.empty_like(positions)
    state = inputs.state
    for h, state in enumerate(unroll(predictor, inputs, commands)):
        positions[:, :, h] = state.position
        velocities[:, :, h] = state.velocity
    return Rollout(positions, velocities, state)
