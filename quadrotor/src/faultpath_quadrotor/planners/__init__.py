"""The planners, with their samplers and costs as objects."""

from faultpath_quadrotor.planners.base import Planner, Search, shift
from faultpath_quadrotor.planners.cem import CEM
from faultpath_quadrotor.planners.costs import CostWeights, NavigationCost, Scored
from faultpath_quadrotor.planners.mppi import MPPI
from faultpath_quadrotor.planners.sampler import (
    AutoregressiveSampler,
    BundledSampler,
    SamplerSettings,
)
