"""Model predictive path integral control, batched over scenes and candidates."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.quadrotor.planners.costs import NavigationCost, Scored
from faultpath.quadrotor.planners.protocol import Planner, Search
from faultpath.quadrotor.planners.sampler import Sampler


class Temperature(ABC):
    """Turns costs into weights: their softmax at a temperature."""

    @abstractmethod
    def of(self, cost: Tensor) -> Tensor:
        """Return the temperature `[S, 1]` for costs `[S, K]`."""

    def weights(self, cost: Tensor) -> Tensor:
        """Return the weights `[S, K]` of candidates with costs `[S, K]`."""
        return torch.softmax(-cost / self.of(cost), dim=1)


@dataclass(frozen=True)
class ScaledTemperature(Temperature):
    """A fraction of the spread of the better half of the costs.

    The better half, because the few candidates that hit something would set the spread of all.
    """

    fraction: float
    least: ClassVar[float] = 1e-3

    @override
    def of(self, cost: Tensor) -> Tensor:
        half = cost.sort(dim=1).values[:, : cost.shape[1] // 2]
        return (half.std(dim=1, keepdim=True) * self.fraction).clamp_(min=self.least)


def weighted_mean(commands: Tensor, weight: Tensor) -> Tensor:
    """Return the mean `[H, 4, S]` of commands `[H, 4, S, K]` under weights `[S, K]`."""
    return (commands * weight).sum(-1)


class MPPI(Planner):
    """Model predictive path integral control: the plan is the mean of the weighted candidates."""

    def __init__(
        self,
        sampler: Sampler,
        cost: NavigationCost,
        temperature: Temperature,
    ) -> None:
        super().__init__(sampler)
        self._cost = cost
        self._temperature = temperature

    @override
    def propose(self, search: Search, noise: Tensor) -> Tensor:
        return self.sampler.candidates(search.plan, search.hover, noise)

    @override
    def update(self, search: Search, scored: Scored) -> Search:
        weights = self._temperature.weights(self._cost(scored))
        return replace(search, plan=weighted_mean(scored.commands, weights))
