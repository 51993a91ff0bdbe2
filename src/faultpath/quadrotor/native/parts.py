"""Where compiled parts take the place of portable ones: nothing else asks which are there."""

from functools import partial

import torch

from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.native.clearance import CompiledDepthClearance
from faultpath.quadrotor.native.costs import CompiledCost, CompiledMean, CompiledTemperature
from faultpath.quadrotor.native.coverage import uncovered
from faultpath.quadrotor.native.lending import is_exactly, tell_portable
from faultpath.quadrotor.native.library import Kernels, kernels, kernels_on
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
from faultpath.quadrotor.planner.mppi import Roll
from faultpath.quadrotor.predictors import Predictor, TrueParameter
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
    roll = _roll(built, predictor)
    return MPPI(predictor, sampler, cost, temperature, roll, CompiledMean(built))


def _roll(built: Kernels, predictor: Predictor) -> Roll:
    if why := uncovered(predictor):
        if not is_exactly(predictor, TrueParameter):  # of which there never was a kernel
            tell_portable(f"The predictor {type(predictor).__name__}", why)
        return partial(rollout, predictor)
    return CompiledRollout(built, predictor)


def depth_clearance(model: ClearanceModel, device: torch.device = CPU) -> DepthClearance:
    """Return the clearance of depth images on `device`, compiled where there are kernels."""
    built = kernels_on(device)
    if built is None:
        return DepthClearance(model)
    if why := CompiledDepthClearance.misfit(model):
        tell_portable(f"The clearance model {type(model).__name__}", why)
        return DepthClearance(model)
    return CompiledDepthClearance(built, model)
