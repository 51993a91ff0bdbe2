"""The cross-entropy method, batched over scenes and candidates."""

from dataclasses import replace

import torch
from pydantic import BaseModel, ConfigDict, Field
from torch import Tensor
from typing_extensions import override

from faultpath.quadrotor.planners.costs import NavigationCost, Scored
from faultpath.quadrotor.planners.protocol import Planner, Search
from faultpath.quadrotor.planners.sampler import Sampler, bound, scales


class CEMSettings(BaseModel):
    """How the search narrows.

    Sources: Rubinstein and Kroese (2004) for the method; Pinneri et al. (2020, "iCEM") for noise
    that is correlated in time and for the momentum.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    iterations: int = Field(default=3, ge=1)
    """Proposals of one step."""
    elites: int = Field(default=64, ge=2)
    """Candidates of least cost, to which plan and spread are fitted."""
    momentum: float = Field(default=0.1, ge=0, lt=1)
    """Share of the former plan and spread that stays."""
    least_spread: float = Field(default=0.05, ge=0)
    """Fraction of the first spread below which it does not fall, so that the search stays open."""


class CEM(Planner):
    """Fits plan and spread to the best candidates, several times a step.

    Each step starts from the plan of the step before, moved on, and from the sampler's spread.
    """

    def __init__(
        self, sampler: Sampler, cost: NavigationCost, settings: CEMSettings | None = None
    ) -> None:
        super().__init__(sampler)
        self.settings = settings or CEMSettings()
        self.iterations = self.settings.iterations
        self._cost = cost

    @override
    def init(self, plan: Tensor, hover: Tensor) -> Search:
        spread = scales(self.sampler.settings, hover)[..., 0].expand(plan.shape)
        return Search(plan, hover, spread)

    @override
    def propose(self, search: Search, noise: Tensor) -> Tensor:
        assert search.spread is not None
        commands = noise.mul_(search.spread[..., None]).add_(search.plan[..., None])
        return bound(commands, search.hover)

    def update(self, search: Search, scored: Scored) -> Search:
        """See `Planner.update`: ties fall to the candidate that was drawn first."""
        assert search.spread is not None
        cost = self._cost(scored)
        count = min(self.settings.elites, cost.shape[1])
        best = cost.sort(dim=1, stable=True).indices[:, :count]
        shape = (*scored.commands.shape[:2], *best.shape)
        elites = scored.commands.gather(-1, best.expand(shape))
        keep = self.settings.momentum
        plan = torch.lerp(elites.mean(-1), search.plan, keep)
        spread = torch.lerp(elites.std(-1, correction=0), search.spread, keep)
        least = scales(self.sampler.settings, search.hover)[..., 0] * self.settings.least_spread
        return replace(search, plan=plan, spread=torch.maximum(spread, least))
