"""The only horizon loop: planner, training and probes all roll a predictor out here."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import torch
from torch import Tensor

from faultpath_quadrotor import native
from faultpath_quadrotor.batching import Chunk
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.native.kernel_args import is_exactly, tell_portable
from faultpath_quadrotor.predictors import Predictor, PredictorInputs, TrueParameter
from faultpath_quadrotor.predictors.base import Rollout
from faultpath_quadrotor.predictors.compiled import HorizonLoop, uncovered
from faultpath_quadrotor.state import State


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
    """Return the function that rolls a predictor out on `device`, compiled where possible.

    A compiled one keeps the weights that the predictor has now. It works along the candidates of a
    scene; where there is only one, torch takes all scenes at once.
    """
    built = native.kernels_on(device)
    if built is None:
        return partial(rollout, predictor)
    if why := uncovered(predictor):
        if not is_exactly(predictor, TrueParameter):  # which never had a kernel
            tell_portable(f"The predictor {type(predictor).__name__}", why)
        return partial(rollout, predictor)
    loop = HorizonLoop(built, predictor)

    def roll(inputs: PredictorInputs, commands: Tensor) -> Rollout:
        if commands.shape[-1] == 1:
            return rollout(predictor, inputs, commands)
        return loop(inputs, commands)

    return roll


@dataclass(frozen=True)
class Candidates:
    """A request to the predictor: where do these commands lead?"""

    count: int
    """Scenes of the batch, B."""
    chunks: tuple[Chunk, ...]
    """The scenes that are planned for."""
    commands: tuple[Tensor, ...]
    """`[H, 4, S, K]` for each chunk, N and rad/s."""


@dataclass(frozen=True)
class Predicted:
    """The predictor's answer, and as such the request to the clearance."""

    count: int
    chunks: tuple[Chunk, ...]
    rollouts: tuple[Rollout, ...]
    """One for each chunk."""

    def motion(self) -> Tensor:
        """Return positions and velocities of the whole batch, `[B, 6, H, K]`, m and m/s.

        Scenes that are not planned for have zeros.
        """
        first = self.rollouts[0].positions
        whole = first.new_zeros(6, self.count, *first.shape[2:])
        for chunk, rollout in zip(self.chunks, self.rollouts, strict=True):
            whole[:3, chunk.rows] = rollout.positions
            whole[3:, chunk.rows] = rollout.velocities
        return whole.movedim(1, 0)

    def moved(self, motion: Tensor) -> "Predicted":
        """Return it with other positions and velocities `[B, 6, H, K]`; attitudes stay."""
        lanes = motion.movedim(0, 1)
        rollouts: list[Rollout] = []
        for chunk, rollout in zip(self.chunks, self.rollouts, strict=True):
            positions, velocities = (x.contiguous() for x in lanes[:, chunk.rows].split(3))
            end = positions[:, :, -1], velocities[:, :, -1]
            final = replace(rollout.final, position=end[0], velocity=end[1])
            rollouts.append(Rollout(positions, velocities, final))
        return replace(self, rollouts=tuple(rollouts))
