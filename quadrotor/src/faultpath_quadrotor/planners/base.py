"""Planners as the loop runs them: a search that starts at a plan, and what makes it better."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike

import torch
from torch import Tensor

from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import lend, output
from faultpath_quadrotor.planners.costs import Scored
from faultpath_quadrotor.planners.sampler import AutoregressiveSampler


@dataclass(frozen=True)
class Search:
    """Where the search of one step stands, for some scenes."""

    plan: Tensor
    """`[H, 4, S]`; its first row would be executed."""
    hover: Tensor
    """Thrust that the predictor believes holds the vehicle, `[S]`, N."""


class Planner(ABC):
    """Proposes candidates and turns their costs into a better plan, any number of times a step.

    It knows no model: rollouts and clearance come through taps between `propose` and `update`.
    Batches are `[S, K]`: scenes and candidates.
    """

    iterations: int = 1
    """Proposals and updates of one step."""
    keeps_modes: bool = False
    """Whether it plans with one bundle of a `BundledSampler`."""
    data_files: Sequence[str | PathLike[str]] | None = None
    """Files that a user's own planner reads, of every seed, such as weights."""

    def __init__(self, sampler: AutoregressiveSampler) -> None:
        self.sampler = sampler

    def initial_plan(self, hover: Tensor) -> Tensor:
        """Return the plan `[H, 4, S]` that hovers, for hover thrust `[S]`."""
        plan = hover.new_zeros(self.sampler.settings.horizon, 4, hover.shape[0])
        plan[:, 0] = hover
        return plan

    def noise(self, scenes: Sequence[str], seed: int, step: int, iteration: int = 0) -> Tensor:
        """Return standardised noise `[H, 4, S, K]` for one proposal."""
        return self.sampler.noise(scenes, seed, step, iteration)

    def init(self, plan: Tensor, hover: Tensor) -> Search:
        """Return where the search of a step starts: at the plan of the step before, moved on."""
        return Search(plan, hover)

    @abstractmethod
    def propose(self, search: Search, noise: Tensor) -> Tensor:
        """Return commands `[H, 4, S, K]` to roll out; `noise` is overwritten."""

    @abstractmethod
    def update(self, search: Search, scored: Scored) -> Search:
        """Return the search with the plan that the candidates' costs make of it."""


def shift(plan: Tensor) -> Tensor:
    """Move a plan `[H, 4, S]` one interval on, repeating its last row: the next warm start."""
    return torch.cat([plan[1:], plan[-1:]])


def mean(commands: Tensor, weights: Tensor) -> Tensor:
    """Return the mean `[H, 4, S]` of commands `[H, 4, S, K]` under weights `[S, K]`."""
    built = native.kernels_for(commands, weights)
    steps, axes, scenes, candidates = commands.shape
    if built is None or not native.whole_vectors(candidates):
        return (commands * weights).sum(-1)
    means = output(steps, axes, scenes)
    built.call(
        "faultpath_mean",
        lend("commands", commands, *commands.shape),
        lend("weights", weights, scenes, candidates),
        *(steps * axes, scenes, candidates, means),
    )
    return means.tensor
