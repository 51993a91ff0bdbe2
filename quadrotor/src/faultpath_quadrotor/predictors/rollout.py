"""The only horizon loop: planner, training and probes all roll a predictor out here."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import torch
from torch import Tensor

from faultpath_quadrotor import native
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.native.lending import is_exactly, tell_portable
from faultpath_quadrotor.predictors import Predictor, PredictorInputs, TrueParameter
from faultpath_quadrotor.predictors.compiled import HorizonLoop, uncovered
from faultpath_quadrotor.state import State


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


Roll = Callable[[PredictorInputs, Tensor], Rollout]
"""Rolls commands `[H, 4, S, K]` out from inputs of batch `[S, 1]`."""


def rolling(predictor: Predictor, device: torch.device = CPU) -> Roll:
    """Return what rolls a predictor out on `device`: compiled where a kernel stands for it.

    A compiled one keeps the weights that the predictor has now. It works along the candidates of a
    scene: of one alone there is nothing to work along, so torch takes all scenes at once.
    """
    built = native.kernels_on(device)
    if built is None:
        return partial(rollout, predictor)
    if why := uncovered(predictor):
        if not is_exactly(predictor, TrueParameter):  # of which there never was a kernel
            tell_portable(f"The predictor {type(predictor).__name__}", why)
        return partial(rollout, predictor)
    loop = HorizonLoop(built, predictor)

    def roll(inputs: PredictorInputs, commands: Tensor) -> Rollout:
        if commands.shape[-1] == 1:
            return rollout(predictor, inputs, commands)
        positions, velocities, rotation, rate = loop(inputs, commands)
        final = State(positions[:, :, -1], velocities[:, :, -1], rotation, rate)
        return Rollout(positions, velocities, final)

    return roll
