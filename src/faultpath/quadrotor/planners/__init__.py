"""The planners, with their samplers and costs as objects."""

from faultpath.quadrotor.planners.cem import CEM, CEMSettings
from faultpath.quadrotor.planners.costs import (
    BlendedGoal,
    CostWeights,
    GoalCost,
    NavigationCost,
    RunningGoal,
    Scored,
    TerminalGoal,
    goal_cost,
)
from faultpath.quadrotor.planners.modes import BundledSampler, WithinBundle
from faultpath.quadrotor.planners.mppi import (
    MPPI,
    ScaledTemperature,
    Temperature,
    weighted_mean,
)
from faultpath.quadrotor.planners.protocol import Planner, Search, shift
from faultpath.quadrotor.planners.sampler import AutoregressiveSampler, Sampler, SamplerSettings

__all__ = [
    "CEM",
    "MPPI",
    "AutoregressiveSampler",
    "BlendedGoal",
    "BundledSampler",
    "CEMSettings",
    "CostWeights",
    "GoalCost",
    "NavigationCost",
    "Planner",
    "RunningGoal",
    "Sampler",
    "SamplerSettings",
    "ScaledTemperature",
    "Scored",
    "Search",
    "Temperature",
    "TerminalGoal",
    "WithinBundle",
    "goal_cost",
    "shift",
    "weighted_mean",
]
