"""The cross-entropy method, on the same samples and costs as MPPI."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor
from typing_extensions import override

from faultpath_quadrotor import so3
from faultpath_quadrotor.planners.base import Planner, Search, mean
from faultpath_quadrotor.planners.costs import NavigationCost, Scored
from faultpath_quadrotor.planners.sampler import AutoregressiveSampler, bound, scales


@dataclass(frozen=True)
class Narrowing(Search):
    """Where the search stands, and how wide it still is."""

    spread: Tensor
    """Standard deviations about the plan, `[H, 4, S]`, N and rad/s."""


class CEM(Planner):
    """Draws, keeps the best, fits mean and standard deviation to them, and draws again.

    A step draws `iterations` times, each time its sampler's candidates. Noise stays correlated
    along the horizon, as in iCEM (Pinneri et al., CoRL 2020), whose share of elites and whose
    momentum these are; a step starts as wide as MPPI, and its last mean is flown.
    """

    iterations = 4
    elites: float = 0.1
    """Share of the candidates that are kept."""
    momentum: float = 0.1
    """Share of the old plan and spread that an update keeps."""

    def __init__(self, sampler: AutoregressiveSampler, cost: NavigationCost) -> None:
        super().__init__(sampler)
        self._cost = cost

    @override
    def init(self, plan: Tensor, hover: Tensor) -> Narrowing:
        spread = scales(self.sampler.settings, hover)[..., 0].expand_as(plan)
        return Narrowing(plan, hover, spread)

    @override
    def propose(self, search: Search, noise: Tensor) -> Tensor:
        assert isinstance(search, Narrowing)
        drawn = noise.mul_(search.spread[..., None]).add_(search.plan[..., None])
        return bound(drawn, search.hover)

    @override
    def update(self, search: Search, scored: Scored) -> Search:
        assert isinstance(search, Narrowing)
        cost = self._cost(scored)
        count = max(2, round(self.elites * cost.shape[1]))
        best = cost.sort(dim=1, stable=True).indices[:, :count]
        # As weights over all candidates, whose sums are the same for any number of scenes.
        weights = torch.zeros_like(cost).scatter_(1, best, 1.0 / count)
        plan = mean(scored.commands, weights)
        variance = mean((scored.commands - plan[..., None]).square_(), weights)
        return replace(
            search,
            plan=plan.lerp(search.plan, self.momentum),
            spread=so3.root(variance).lerp(search.spread, self.momentum),
        )
