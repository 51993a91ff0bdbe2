"""The planners, with their samplers and costs as objects."""

from faultpath.quadrotor.planners.costs import CostWeights, NavigationCost, Scored
from faultpath.quadrotor.planners.mppi import MPPI
from faultpath.quadrotor.planners.protocol import Planner, Search, shift
from faultpath.quadrotor.planners.sampler import (
    AutoregressiveSampler,
    BundledSampler,
    SamplerSettings,
)

__all__ = [
    "MPPI",
    "AutoregressiveSampler",
    "BundledSampler",
    "CostWeights",
    "NavigationCost",
    "Planner",
    "SamplerSettings",
    "Scored",
    "Search",
    "shift",
]
