"""The planners, with their samplers and costs as objects."""

from faultpath.quadrotor.planner.cem import CEM, CEMSettings
from faultpath.quadrotor.planner.costs import (
    BlendedGoal,
    CostWeights,
    GoalCost,
    NavigationCost,
    RunningGoal,
    Scored,
    TerminalGoal,
    goal_cost,
)
from faultpath.quadrotor.planner.modes import BundledSampler, WithinBundle
from faultpath.quadrotor.planner.mppi import (
    MPPI,
    ScaledTemperature,
    Temperature,
    weighted_mean,
)
from faultpath.quadrotor.planner.protocol import Planner, Search, shift
from faultpath.quadrotor.planner.sampler import AutoregressiveSampler, Sampler, SamplerSettings

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
