"""Which predictors the compiled horizon loop stands for: these exactly, of sizes that it can hold.

A subclass of a shipped predictor may step as it likes, so it flies as it is, on the portable path.
"""

import torch

from faultpath.quadrotor.device import at_hand
from faultpath.quadrotor.native.lending import is_exactly, unlike
from faultpath.quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    LatentNetwork,
    Predictor,
    UnanchoredNetwork,
    UnanchoredPredictor,
)
from faultpath.quadrotor.predictors.drag import LinearDrag
from faultpath.quadrotor.predictors.network import (
    ACTION_EMBEDDING,
    ACTION_FEATURES,
    BASE_FEATURES,
    LATENT,
)
from faultpath.quadrotor.predictors.unanchored import OUTPUTS

MOST_HIDDEN = 128
"""Fixed in `rollout.cpp`: the rows of a hidden layer."""
RESIDUALS = 6


def uncovered(predictor: Predictor) -> str:
    """Return in words why no compiled rollout stands for `predictor`; empty where one does."""
    if is_exactly(predictor, UnanchoredPredictor):
        return _network(predictor.network, UnanchoredNetwork, BASE_FEATURES + 2, OUTPUTS)
    if is_exactly(predictor, AnchoredPredictor):
        network = _network(predictor.network, LatentNetwork, BASE_FEATURES, RESIDUALS)
        return network or _integrator(predictor.kinematics)
    if isinstance(predictor, KinematicIntegrator):
        return _integrator(predictor)
    for kind in (UnanchoredPredictor, AnchoredPredictor):
        if isinstance(predictor, kind):
            return unlike(kind, predictor)
    return "there is a kernel of the shipped predictors only"


def _integrator(integrator: KinematicIntegrator) -> str:
    if not is_exactly(integrator, KinematicIntegrator):
        return unlike(KinematicIntegrator, integrator)
    air = integrator.air
    return "" if is_exactly(air, LinearDrag) else unlike(LinearDrag, air)


@torch.no_grad()
def _network(network: LatentNetwork, kind: type[LatentNetwork], width: int, outputs: int) -> str:
    if not is_exactly(network, kind):
        return unlike(kind, network)
    tensors = (*network.parameters(), *network.buffers())
    if any(part.dtype != torch.float32 or not at_hand(part.device) for part in tensors):
        return "its weights are not float32 on the CPU"
    folded = network.fold()
    first, second = len(folded.first) - 1, len(folded.second) - 1
    if max(first, second) > MOST_HIDDEN:
        return f"its kernel has room for {MOST_HIDDEN} hidden units, not {max(first, second)}"
    shapes = {
        "embed": (ACTION_EMBEDDING + 1, ACTION_FEATURES + 1),
        "gates": (2 * LATENT, ACTION_EMBEDDING + 1 + LATENT),
        "candidate": (LATENT, ACTION_EMBEDDING + 1),
        "remembered": (LATENT, 1 + LATENT),
        "first": (first + 1, LATENT + width + 1),
        "second": (second + 1, first + 1),
        "last": (outputs, second + 1),
    }
    wrong = [name for name, shape in shapes.items() if getattr(folded, name).shape != shape]
    if isinstance(network, UnanchoredNetwork) and network.increment_std.shape != (OUTPUTS, 1):
        wrong.append("increment_std")
    return f"the size of its layer '{wrong[0]}' is another" if wrong else ""
