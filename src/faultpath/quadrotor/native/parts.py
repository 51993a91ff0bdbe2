"""Where compiled parts take the place of portable ones: nothing else asks which are there."""

from functools import partial

import torch

from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.native.clearance import CompiledDepthClearance
from faultpath.quadrotor.native.costs import CompiledCost, CompiledMean, CompiledTemperature
from faultpath.quadrotor.native.library import kernels, kernels_on
from faultpath.quadrotor.native.rollout import CompiledRollout
from faultpath.quadrotor.native.sampling import CompiledSampler
from faultpath.quadrotor.perception import ClearanceModel, DepthClearance
from faultpath.quadrotor.planner import (
    MPPI,
    BundledSampler,
    NavigationCost,
    Sampler,
    Temperature,
    WithinBundle,
    weighted_mean,
)
from faultpath.quadrotor.predictors import Predictor
from faultpath.quadrotor.rollout import rollout


def build_planner(
    predictor: Predictor,
    sampler: Sampler,
    cost: NavigationCost,
    temperature: Temperature,
    device: torch.device = CPU,
    bundled: bool = False,
) -> MPPI:
    """Return the planner for `device`, compiled as far as there are kernels for its parts.

    `bundled` keeps its modes apart; see `planner.modes`.
    """
    host, built = kernels(), kernels_on(device)
    if host is not None and CompiledSampler.covers(sampler):
        sampler = CompiledSampler(host, sampler)  # the host draws for every device
    if built is not None and CompiledTemperature.covers(temperature):
        temperature = CompiledTemperature(built, temperature)
    if bundled:
        sampler, temperature = BundledSampler(sampler), WithinBundle(temperature)
    if built is None:
        roll, mean = partial(rollout, predictor), weighted_mean
        return MPPI(predictor, sampler, cost, temperature, roll, mean)
    if CompiledCost.covers(cost):
        cost = CompiledCost(built, cost)
    covered = CompiledRollout.covers(predictor)
    roll = CompiledRollout(built, predictor) if covered else partial(rollout, predictor)
    return MPPI(predictor, sampler, cost, temperature, roll, CompiledMean(built))


def depth_clearance(model: ClearanceModel, device: torch.device = CPU) -> DepthClearance:
    """Return the clearance of depth images on `device`, compiled where there are kernels."""
    built = kernels_on(device)
    return DepthClearance(model) if built is None else CompiledDepthClearance(built, model)
