"""Model predictive path integral control, batched over scenes and candidates."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from faultpath.quadrotor import native
from faultpath.quadrotor.native import costs
from faultpath.quadrotor.native.lending import covered
from faultpath.quadrotor.planner.costs import NavigationCost, Scored
from faultpath.quadrotor.planner.sampler import Sampler
from faultpath.quadrotor.predictors import Predictor, PredictorInputs
from faultpath.quadrotor.rollout import Roll, Rollout
from faultpath.quadrotor.vehicle import GRAVITY_MPS2


class Temperature(ABC):
    """Turns costs into weights: their softmax at a temperature."""

    @abstractmethod
    def of(self, cost: Tensor) -> Tensor:
        """Return the temperature `[S, 1]` for costs `[S, K]`."""

    def weights(self, cost: Tensor) -> Tensor:
        """Return the weights `[S, K]` of candidates with costs `[S, K]`."""
        return torch.softmax(-cost / self.of(cost), dim=1)


@dataclass(frozen=True)
class FixedTemperature(Temperature):
    """The same temperature at every replan."""

    value: float

    def of(self, cost: Tensor) -> Tensor:
        """See `Temperature.of`."""
        return torch.full_like(cost[:, :1], self.value)


@dataclass(frozen=True)
class ScaledTemperature(Temperature):
    """A fraction of the spread of the better half of the costs.

    The better half, because the few candidates that hit something would set the spread of all.
    """

    fraction: float
    least: ClassVar[float] = 1e-3

    def of(self, cost: Tensor) -> Tensor:
        """See `Temperature.of`."""
        half = cost.sort(dim=1).values[:, : cost.shape[1] // 2]
        return (half.std(dim=1, keepdim=True) * self.fraction).clamp_(min=self.least)

    def weights(self, cost: Tensor) -> Tensor:
        """See `Temperature.weights`; the kernel sorts no more than it must."""
        built = native.kernels_for(cost)
        if built is None or not native.whole_vectors(cost.shape[1]):
            return super().weights(cost)
        if not covered(self, ScaledTemperature):
            return super().weights(cost)
        return costs.weights(built, cost, self.fraction, self.least)


@dataclass(frozen=True)
class Proposal:
    """Candidates and where the predictor says they lead."""

    commands: Tensor
    """`[H, 4, S, K]`."""
    rollout: Rollout
    hover: Tensor
    """Thrust that the predictor believes holds the vehicle, `[S]`, N."""


def weighted_mean(commands: Tensor, weight: Tensor) -> Tensor:
    """Return the mean `[H, 4, S]` of commands `[H, 4, S, K]` under weights `[S, K]`."""
    built = native.kernels_for(commands, weight)
    if built is None or not native.whole_vectors(commands.shape[-1]):
        return (commands * weight).sum(-1)
    return costs.mean(built, commands, weight)


class MPPI:
    """Proposes candidates, then turns their costs into the next plan.

    It knows no model: it sees a predictor that rolls commands out. The two halves of a replan are
    apart because the clearance along the rollout comes through a tap in between.
    """

    def __init__(
        self,
        predictor: Predictor,
        sampler: Sampler,
        cost: NavigationCost,
        temperature: Temperature,
        roll: Roll,
    ) -> None:
        self.predictor = predictor
        self.sampler = sampler
        self._cost = cost
        self._temperature = temperature
        self._roll = roll

    def initial_plan(self, hover: Tensor) -> Tensor:
        """Return the plan `[H, 4, S]` that hovers, for hover thrust `[S]`."""
        plan = hover.new_zeros(self.sampler.settings.horizon, 4, hover.shape[0])
        plan[:, 0] = hover
        return plan

    def propose(self, inputs: PredictorInputs, plan: Tensor, noise: Tensor) -> Proposal:
        """Roll candidates around `plan` `[H, 4, S]` out; `noise` `[H, 4, S, K]` is overwritten."""
        hover = inputs.trim.hover_thrust(GRAVITY_MPS2)[:, 0]
        commands = self.sampler.candidates(plan, hover, noise)
        return Proposal(commands, self._roll(inputs, commands), hover)

    def decide(self, proposal: Proposal, clearance: Tensor, goal: Tensor) -> Tensor:
        """Return the improved plan `[H, 4, S]`; its first row is the command to execute.

        `clearance` is `[S, H, K]` along the proposal's positions, `goal` `[3, S]`.
        """
        commands = proposal.commands
        cost = self._cost(Scored(proposal.rollout, commands, clearance, goal, proposal.hover))
        return weighted_mean(commands, self._temperature.weights(cost))


def shift(plan: Tensor) -> Tensor:
    """Move a plan `[H, 4, S]` one interval on, repeating its last row: the next warm start."""
    return torch.cat([plan[1:], plan[-1:]])
