"""The planner: MPPI with its samplers and costs as objects."""

from faultpath.quadrotor.planner.costs import (
    CostWeights,
    GoalCost,
    NavigationCost,
    RunningGoal,
    Scored,
    TerminalGoal,
)
from faultpath.quadrotor.planner.modes import BundledSampler, WithinBundle
from faultpath.quadrotor.planner.mppi import (
    MPPI,
    FixedTemperature,
    Proposal,
    ScaledTemperature,
    Temperature,
    shift,
    weighted_mean,
)
from faultpath.quadrotor.planner.sampler import AutoregressiveSampler, Sampler, SamplerSettings

__all__ = [
    "MPPI",
    "AutoregressiveSampler",
    "BundledSampler",
    "CostWeights",
    "FixedTemperature",
    "GoalCost",
    "NavigationCost",
    "Proposal",
    "RunningGoal",
    "Sampler",
    "SamplerSettings",
    "ScaledTemperature",
    "Scored",
    "Temperature",
    "TerminalGoal",
    "WithinBundle",
    "shift",
    "weighted_mean",
]
