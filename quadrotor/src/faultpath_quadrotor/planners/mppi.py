"""Model predictive path integral control, batched over scenes and candidates."""

import ctypes
from dataclasses import replace

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import lend, output
from faultpath_quadrotor.planners.base import Planner, Search, mean
from faultpath_quadrotor.planners.costs import NavigationCost, Scored
from faultpath_quadrotor.planners.sampler import BUNDLES, AutoregressiveSampler, BundledSampler

LEAST_TEMPERATURE = 1e-3


class MPPI(Planner):
    """Model predictive path integral control: the plan is the mean of the weighted candidates.

    Weights are the softmax of the costs at a fraction of the spread of the better half: the few
    candidates that hit something would set the spread of all. A mean over all candidates may lie
    between two ways round an obstacle, in the obstacle; with a `BundledSampler` only the bundle
    with the most weight counts.
    """

    keeps_modes = True

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


def softmax(cost: Tensor, fraction: float) -> Tensor:
    """Return the weights `[S, K]` of candidates with costs `[S, K]`; see `MPPI`."""
    built = native.kernels_for(cost)
    scenes, candidates = cost.shape
    if built is None or not native.whole_vectors(candidates):
        half = cost.sort(dim=1).values[:, : candidates // 2]
        temperature = (half.std(dim=1, keepdim=True) * fraction).clamp_(min=LEAST_TEMPERATURE)
        return torch.softmax(-cost / temperature, dim=1)
    ranks, weights = output(candidates, dtype=torch.int32), output(scenes, candidates)
    built.call(
        "faultpath_weigh",
        lend("costs", cost, scenes, candidates),
        (ctypes.c_float * 2)(fraction, LEAST_TEMPERATURE),
        *(scenes, candidates, ranks, weights),
    )
    return weights.tensor


def best_bundle(weights: Tensor) -> Tensor:
    """Leave the weights `[S, K]` to the bundle that has the most of them."""
    bundles = weights.unflatten(1, (BUNDLES, -1))
    total = bundles.sum(2, keepdim=True)
    best = torch.zeros_like(total).scatter_(1, total.argmax(1, keepdim=True), 1.0)
    return (bundles * best / total.clamp_min(1e-30)).flatten(1)
