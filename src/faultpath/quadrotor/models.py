"""What can stand at each place of the controller, by name, and its trained weights."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import torch

from faultpath.quadrotor.checkpoint import checkpoint_path, load_checkpoint
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.perception import ClearanceModel
from faultpath.quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    Predictor,
    TrueParameter,
    UnanchoredPredictor,
)
from faultpath.quadrotor.reconstruction import (
    DisturbanceObserver,
    Reconstruction,
    RecurrentReconstruction,
    WindNetwork,
)

PredictorLoader = Callable[[str, int | None], Predictor]
ReconstructionLoader = Callable[[str, int | None], Reconstruction]


@dataclass(frozen=True)
class PredictorKind:
    """A predictor by name."""

    description: str
    load: PredictorLoader
    """`load(name, seed)`; without a seed the weights are blank: enough to know what it reads."""


@dataclass(frozen=True)
class ReconstructionKind:
    """A wind reconstruction by name."""

    description: str
    load: ReconstructionLoader


def _anchored(wind: bool) -> PredictorLoader:
    def load(name: str, seed: int | None) -> Predictor:
        network = AnchoredPredictor.build_network()
        if seed is not None:
            load_checkpoint(network, checkpoint_path(name, seed))
        return AnchoredPredictor(network, wind)

    return load


def _unanchored(name: str, seed: int | None) -> Predictor:
    network = UnanchoredPredictor.build_network()
    if seed is not None:
        load_checkpoint(network, checkpoint_path(name, seed))
    return UnanchoredPredictor(network)


def _analytic(build: Callable[[], Predictor]) -> PredictorLoader:
    return lambda name, seed: build()


def _recurrent(calibrated: bool) -> ReconstructionLoader:
    def load(name: str, seed: int | None) -> Reconstruction:
        network = WindNetwork(calibrated)
        if seed is not None:
            load_checkpoint(network, checkpoint_path(name, seed))
        return RecurrentReconstruction(network)

    return load


PREDICTORS: Mapping[str, PredictorKind] = MappingProxyType(
    {
        "dki": PredictorKind("kinematic integrator", _analytic(KinematicIntegrator)),
        "dki-drag": PredictorKind(
            "kinematic integrator with nominal drag",
            _analytic(lambda: KinematicIntegrator(drag=True)),
        ),
        "true-parameter": PredictorKind("the vehicle's own parameters", _analytic(TrueParameter)),
        "wm-a": PredictorKind("anchored model", _anchored(wind=False)),
        "wm-a+dcc": PredictorKind("anchored model, calibration noise", _anchored(wind=False)),
        "wm-u": PredictorKind("unanchored model", _unanchored),
        "wm-u+dcc": PredictorKind("unanchored model, calibration noise", _unanchored),
        "wm-a-wind": PredictorKind("anchored model, wind-conditioned", _anchored(wind=True)),
        "wm-a-nowind": PredictorKind("anchored model, wind withheld", _anchored(wind=False)),
    }
)

RECONSTRUCTIONS: Mapping[str, ReconstructionKind] = MappingProxyType(
    {
        "dob": ReconstructionKind(
            "the disturbance observer", lambda name, seed: DisturbanceObserver()
        ),
        "gru": ReconstructionKind("the learned reconstruction", _recurrent(calibrated=True)),
        "gru+dcc": ReconstructionKind(
            "the learned reconstruction, trained with calibration noise",
            _recurrent(calibrated=True),
        ),
        "gru-withheld": ReconstructionKind(
            "a learned reconstruction without calibration", _recurrent(calibrated=False)
        ),
        "gru-trajectory": ReconstructionKind(
            "a reconstruction that learned from closed-loop flights, without calibration",
            _recurrent(calibrated=False),
        ),
    }
)


def predictor(name: str, seed: int | None, device: torch.device = CPU) -> Predictor:
    """Return a predictor of `PREDICTORS`; `UserError` where a checkpoint is missing."""
    return _predictor(name, seed, device)


def reconstruction(name: str, seed: int | None, device: torch.device = CPU) -> Reconstruction:
    """Return a reconstruction of `RECONSTRUCTIONS`; `UserError` for a missing checkpoint."""
    return _reconstruction(name, seed, device)


def clearance_model(device: torch.device = CPU) -> ClearanceModel:
    """Return the trained clearance model; `UserError` where its checkpoint is missing."""
    return _clearance_model(device)


@lru_cache
def _predictor(name: str, seed: int | None, device: torch.device) -> Predictor:
    with device:
        return PREDICTORS[name].load(name, seed)


@lru_cache
def _reconstruction(name: str, seed: int | None, device: torch.device) -> Reconstruction:
    with device:
        return RECONSTRUCTIONS[name].load(name, seed)


@lru_cache
def _clearance_model(device: torch.device) -> ClearanceModel:
    with device:
        model = ClearanceModel()
    load_checkpoint(model, checkpoint_path("clearance", 0))
    return model.eval()
