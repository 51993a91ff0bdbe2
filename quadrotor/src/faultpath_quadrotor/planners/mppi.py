"""Model predictive path integral control, batched over scenes and candidates."""

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import PathLike

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import as_kernel_argument
from faultpath_quadrotor.planners.costs import NavigationCost, Scored
from faultpath_quadrotor.planners.sampler import BUNDLES, AutoregressiveSampler, BundledSampler


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


LEAST_TEMPERATURE = 1e-3


class MPPI(Planner):
    """Model predictive path integral control: the plan is the mean of the weighted candidates.

    Weights are the softmax of the costs at a fraction of the spread of the better half: the few
    candidates that hit something would set the spread of all. A mean over all candidates may lie
    between two ways round an obstacle, in the obstacle; with a `BundledSampler` only the bundle
    with the most weight counts.
    """

    def __init__(
        self, sampler: AutoregressiveSampler, cost: NavigationCost, temperature: float
    ) -> None:
        super().__init__(sampler)
        self._cost = cost
        self._temperature = temperature

    @override
    def propose(self, search: Search, noise: Tensor) -> Tensor:
        return self.sampler.candidates(search.plan, search.hover, noise)

    @override
    def update(self, search: Search, scored: Scored) -> Search:
        weights = softmax(self._cost(scored), self._temperature)
        if isinstance(self.sampler, BundledSampler):
            weights = best_bundle(weights)
        return replace(search, plan=mean(scored.commands, weights))


def mean(commands: Tensor, weights: Tensor) -> Tensor:
    """Return the mean `[H, 4, S]` of commands `[H, 4, S, K]` under weights `[S, K]`."""
    built = native.kernels_for(commands, weights)
    steps, axes, scenes, candidates = commands.shape
    if built is None or not native.whole_vectors(candidates):
        return (commands * weights).sum(-1)
    means = commands.new_empty(steps, axes, scenes)
    built.call(
        "faultpath_mean",
        as_kernel_argument("commands", commands.contiguous(), steps, axes, scenes, candidates),
        as_kernel_argument("weights", weights.contiguous(), scenes, candidates),
        *(steps * axes, scenes, candidates),
        as_kernel_argument("means", means, steps, axes, scenes),
    )
    return means


def softmax(cost: Tensor, fraction: float) -> Tensor:
    """Return the weights `[S, K]` of candidates with costs `[S, K]`; see `MPPI`."""
    built = native.kernels_for(cost)
    scenes, candidates = cost.shape
    if built is None or not native.whole_vectors(candidates):
        half = cost.sort(dim=1).values[:, : candidates // 2]
        temperature = (half.std(dim=1, keepdim=True) * fraction).clamp_(min=LEAST_TEMPERATURE)
        return torch.softmax(-cost / temperature, dim=1)
    ranks, weights = torch.empty(candidates, dtype=torch.int32), torch.empty_like(cost)
    built.call(
        "faultpath_weigh",
        as_kernel_argument("costs", cost.contiguous(), scenes, candidates),
        (ctypes.c_float * 2)(fraction, LEAST_TEMPERATURE),
        *(scenes, candidates),
        as_kernel_argument("ranks", ranks, candidates, dtype=torch.int32),
        as_kernel_argument("weights", weights, scenes, candidates),
    )
    return weights


def best_bundle(weights: Tensor) -> Tensor:
    """Leave the weights `[S, K]` to the bundle that has the most of them."""
    bundles = weights.unflatten(1, (BUNDLES, -1))
    total = bundles.sum(2, keepdim=True)
    best = torch.zeros_like(total).scatter_(1, total.argmax(1, keepdim=True), 1.0)
    return (bundles * best / total.clamp_min(1e-30)).flatten(1)
