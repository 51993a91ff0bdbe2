"""The shipped predictors as the compiled horizon loop knows them: these exactly, of its sizes.

A subclass of a shipped predictor may step as it likes, so it flies as it is, on the portable path.
"""

from collections.abc import Mapping

import torch
from torch import Tensor

from faultpath.quadrotor.device import host_readable
from faultpath.quadrotor.native.lending import is_exactly, unlike
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.predictors.anchored import (
    ANGULAR_BOUND_RADPS2,
    LINEAR_BOUND_MPS2,
    AnchoredPredictor,
)
from faultpath.quadrotor.predictors.base import Predictor, PredictorInputs
from faultpath.quadrotor.predictors.drag import LinearDrag
from faultpath.quadrotor.predictors.horizon import HorizonLoop, Kind, Step, misfit
from faultpath.quadrotor.predictors.kinematic import KinematicIntegrator
from faultpath.quadrotor.predictors.network import ACTION_EMBEDDING, FoldedNetwork, LatentNetwork
from faultpath.quadrotor.predictors.unanchored import (
    OUTPUTS,
    UnanchoredNetwork,
    UnanchoredPredictor,
)
from faultpath.quadrotor.vehicle import GRAVITY_MPS2


def uncovered(predictor: Predictor) -> str:
    """Return in words why no compiled loop stands for `predictor`; empty where one does."""
    if is_exactly(predictor, UnanchoredPredictor):
        return _network(predictor.network, UnanchoredNetwork, Kind.UNANCHORED)
    if is_exactly(predictor, AnchoredPredictor):
        network = _network(predictor.network, LatentNetwork, Kind.ANCHORED)
        return network or _integrator(predictor.kinematics)
    if isinstance(predictor, KinematicIntegrator):
        return _integrator(predictor)
    for kind in (UnanchoredPredictor, AnchoredPredictor):
        if isinstance(predictor, kind):
            return unlike(kind, predictor)
    return "there is a kernel of the shipped predictors only"


def horizon_loop(kernels: Kernels, predictor: Predictor) -> HorizonLoop:
    """Return the compiled loop with the weights that `predictor` has now.

    Raises `ValueError` where `uncovered` has a reason.
    """
    if why := uncovered(predictor):
        raise ValueError(f"no compiled rollout of {type(predictor).__name__}: {why}")
    if isinstance(predictor, UnanchoredPredictor):
        network = predictor.network
        spread = tuple(network.increment_std.flatten().tolist())
        step = Step(Kind.UNANCHORED, GRAVITY_MPS2, spread=spread)
        return HorizonLoop(kernels, step, _layers(network))
    if isinstance(predictor, AnchoredPredictor):
        step = _kinematics(Kind.ANCHORED, predictor.kinematics)
        return HorizonLoop(kernels, step, _layers(predictor.network))
    assert isinstance(predictor, KinematicIntegrator)
    return HorizonLoop(kernels, _kinematics(Kind.KINEMATIC, predictor), {})


def named(inputs: PredictorInputs) -> Mapping[str, Tensor | None]:
    """Return what a predictor is told, by the names of the compiled loop."""
    state, dynamics, shown = inputs.state, inputs.dynamics, inputs.conditioning
    return {
        "position": state.position,
        "velocity": state.velocity,
        "rotation": state.rotation,
        "rate": state.rate,
        "mass": dynamics and dynamics.mass_kg,
        "thrust_scale": dynamics and dynamics.thrust_scale,
        "wind": inputs.wind_mps,
        "wind_mass": inputs.wind_map_mass_kg,
        "thrust_mass": inputs.thrust_mass_kg,
        "shown_mass": shown and shown.mass_kg,
        "shown_scale": shown and shown.thrust_scale,
        "code": inputs.code,
    }


def _integrator(integrator: KinematicIntegrator) -> str:
    if not is_exactly(integrator, KinematicIntegrator):
        return unlike(KinematicIntegrator, integrator)
    air = integrator.air
    return "" if is_exactly(air, LinearDrag) else unlike(LinearDrag, air)


def _network(network: LatentNetwork, exactly: type[LatentNetwork], kind: Kind) -> str:
    if not is_exactly(network, exactly):
        return unlike(exactly, network)
    tensors = (*network.parameters(), *network.buffers())
    if any(part.dtype != torch.float32 or not host_readable(part.device) for part in tensors):
        return "its weights are not float32 on the CPU"
    if isinstance(network, UnanchoredNetwork) and network.increment_std.shape != (OUTPUTS, 1):
        return "the size of its layer 'increment_std' is another"
    return misfit(kind, _layers(network))


def _kinematics(kind: Kind, integrator: KinematicIntegrator) -> Step:
    dt, keep, mean = integrator.step_constants
    return Step(
        kind,
        GRAVITY_MPS2,
        windy="wind_map" in integrator.reads,
        dragging=integrator.drag,
        dt=dt,
        keep=keep,
        mean=mean,
        linear_bound=LINEAR_BOUND_MPS2,
        angular_bound=ANGULAR_BOUND_RADPS2,
        drag=integrator.air.coefficients_kgps,
    )


@torch.no_grad()
def _layers(network: LatentNetwork) -> Mapping[str, Tensor]:
    folded: FoldedNetwork = network.fold()
    split, gates = ACTION_EMBEDDING, folded.gates
    return {
        "embed": _bias_first(folded.embed[:-1]),
        "gates": torch.cat(
            (gates[:, split : split + 1], gates[:, :split], gates[:, split + 1 :]), 1
        ),
        "candidate": _bias_first(folded.candidate),
        "remembered": folded.remembered,
        "first": _bias_first(folded.first[:-1]),
        "second": _bias_first(folded.second[:-1]),
        "last": _bias_first(folded.last),
    }


def _bias_first(weights: Tensor) -> Tensor:
    return weights.roll(1, dims=1)
