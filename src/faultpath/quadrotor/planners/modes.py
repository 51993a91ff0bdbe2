"""A planner that keeps its modes apart: candidates in bundles, and plans from one bundle only.

A mean over all candidates may lie between two ways round an obstacle, in the obstacle. Here
candidates come in bundles around drawn centres, and the plan is the mean of the best bundle.
"""

import math
from collections.abc import Sequence

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.quadrotor.planners.mppi import Temperature
from faultpath.quadrotor.planners.sampler import Sampler

BUNDLES = 8
"""Divides every number of candidates that the options offer."""
SHARED = 0.5
"""Share of a candidate's variance that is its bundle's centre (derived: as much between bundles as
within them)."""


class BundledSampler(Sampler):
    """Candidates of another sampler in bundles of neighbours.

    The first candidate of a bundle is its centre. Each other one is drawn anew about it, so a
    candidate alone is distributed as before. The first bundle's centre is the plan itself.
    """

    def __init__(self, sampler: Sampler) -> None:
        self.settings = sampler.settings
        self._sampler = sampler

    @override
    def noise(self, scenes: Sequence[str], seed: int, step: int, iteration: int = 0) -> Tensor:
        noise = self._sampler.noise(scenes, seed, step, iteration)
        bundled = noise.unflatten(-1, (BUNDLES, -1))
        bundled[..., 1:].mul_(math.sqrt(1 - SHARED)).add_(bundled[..., :1], alpha=math.sqrt(SHARED))
        return noise

    @override
    def candidates(self, plan: Tensor, hover: Tensor, noise: Tensor) -> Tensor:
        return self._sampler.candidates(plan, hover, noise)


class WithinBundle(Temperature):
    """The weights of another temperature, left to the bundle that has the most of them."""

    def __init__(self, temperature: Temperature) -> None:
        self._temperature = temperature

    @override
    def of(self, cost: Tensor) -> Tensor:
        return self._temperature.of(cost)

    @override
    def weights(self, cost: Tensor) -> Tensor:
        weights = self._temperature.weights(cost).unflatten(1, (BUNDLES, -1))
        total = weights.sum(2, keepdim=True)
        best = torch.zeros_like(total).scatter_(1, total.argmax(1, keepdim=True), 1.0)
        return (weights * best / total.clamp_min(1e-30)).flatten(1)
