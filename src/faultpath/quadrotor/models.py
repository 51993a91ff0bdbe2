"""What can stand at each place of the controller, by name, and its trained weights."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Generic, TypeVar

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

Model = TypeVar("Model", Predictor, Reconstruction)


@dataclass(frozen=True)
class Kind(Generic[Model]):
    """A predictor or a wind reconstruction by name."""

    description: str
    build: Callable[[], Model]
    """Makes it, with blank weights where it has any: enough to know what it reads."""

    def load(self, name: str, seed: int | None, folder: Path | None = None) -> Model:
        """Return it as trained with a seed, by default from the package; blank for `None`.

        Raises `UserError` where there is no checkpoint, or it cannot be read.
        """
        made = self.build()
        if seed is not None and isinstance(made, _LEARNED):
            load_checkpoint(made.network, checkpoint_path(name, seed, folder))
        return made


_LEARNED = (AnchoredPredictor, UnanchoredPredictor, RecurrentReconstruction)


def _anchored(wind: bool) -> Callable[[], Predictor]:
    return lambda: AnchoredPredictor(AnchoredPredictor.build_network(), wind)


def _unanchored() -> Predictor:
    return UnanchoredPredictor(UnanchoredPredictor.build_network())


def _recurrent(calibrated: bool) -> Callable[[], Reconstruction]:
    return lambda: RecurrentReconstruction(WindNetwork(calibrated))


PREDICTORS: Mapping[str, Kind[Predictor]] = MappingProxyType(
    {
        "dki": Kind("kinematic integrator", KinematicIntegrator),
        "dki-drag": Kind(
            "kinematic integrator with nominal drag", lambda: KinematicIntegrator(drag=True)
        ),
        "true-parameter": Kind("the vehicle's own parameters", TrueParameter),
        "wm-a": Kind("anchored model", _anchored(wind=False)),
        "wm-a+dcc": Kind("anchored model, calibration noise", _anchored(wind=False)),
        "wm-u": Kind("unanchored model", _unanchored),
        "wm-u+dcc": Kind("unanchored model, calibration noise", _unanchored),
        "wm-a-wind": Kind("anchored model, wind-conditioned", _anchored(wind=True)),
        "wm-a-nowind": Kind("anchored model, wind withheld", _anchored(wind=False)),
    }
)

RECONSTRUCTIONS: Mapping[str, Kind[Reconstruction]] = MappingProxyType(
    {
        "dob": Kind("the disturbance observer", DisturbanceObserver),
        "gru": Kind("the learned reconstruction", _recurrent(calibrated=True)),
        "gru+dcc": Kind(
            "the learned reconstruction, trained with calibration noise",
            _recurrent(calibrated=True),
        ),
        "gru-withheld": Kind(
            "a learned reconstruction without calibration", _recurrent(calibrated=False)
        ),
        "gru-trajectory": Kind(
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
