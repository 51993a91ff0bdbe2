"""Parts that can take each place of the controller, by name, and their trained weights."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Generic, TypeVar

import torch
from torch import nn

from faultpath.plugin.system import UserError
from faultpath_quadrotor.checkpoint import checkpoint_path, load_checkpoint
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.perception import ClearanceModel
from faultpath_quadrotor.platform import CLEARANCE, PLATFORM
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    Predictor,
    TrueParameter,
    UnanchoredPredictor,
)
from faultpath_quadrotor.reconstruction import (
    DisturbanceObserver,
    InertialObserver,
    Reconstruction,
    RecurrentReconstruction,
    WindNetwork,
)

Model = TypeVar("Model", Predictor, Reconstruction)


def fill(network: nn.Module, name: str, seed: int) -> None:
    """Fill a network with its shipped weights.

    Raises `UserError` where they are missing or were fitted for another platform.
    """
    platform = PLATFORM.weights_hash(name)
    card = load_checkpoint(network, checkpoint_path(name, seed))
    if card.platform != platform:
        raise UserError(
            f"the weights of {card.stem} were fitted for another platform ({card.platform}) than "
            f"the one that is flown ({platform}): fit them again"
        )


@dataclass(frozen=True)
class NamedModel(Generic[Model]):
    """A predictor or a wind reconstruction by name."""

    description: str
    build: Callable[[], Model]
    """Builds it with blank weights, which is enough to know what it reads."""

    def load(self, name: str, seed: int | None) -> Model:
        """Return it as trained with a seed; blank for `None`.

        Raises `UserError` where there is no checkpoint, it cannot be read, or is of another
        platform.
        """
        model = self.build()
        if seed is not None and isinstance(model, _LEARNED):
            fill(model.network, name, seed)
        return model


_LEARNED = (AnchoredPredictor, UnanchoredPredictor, RecurrentReconstruction)


_DRAG = PLATFORM.drag_kgps


def _integrator(drag: bool) -> Callable[[], Predictor]:
    return lambda: KinematicIntegrator(drag, drag_kgps=_DRAG)


def _anchored(wind: bool) -> Callable[[], Predictor]:
    return lambda: AnchoredPredictor(AnchoredPredictor.build_network(), wind, _DRAG)


def _unanchored() -> Predictor:
    return UnanchoredPredictor(UnanchoredPredictor.build_network())


def _recurrent(calibrated: bool) -> Callable[[], Reconstruction]:
    return lambda: RecurrentReconstruction(WindNetwork(calibrated))


PREDICTORS: Mapping[str, NamedModel[Predictor]] = MappingProxyType(
    {
        "dki": NamedModel("physics without drag", _integrator(drag=False)),
        "dki-drag": NamedModel("physics with nominal drag", _integrator(drag=True)),
        "true-parameter": NamedModel(
            "the simulator's physics and parameters",
            TrueParameter,
        ),
        "wm-a": NamedModel("physics with a learned correction", _anchored(wind=False)),
        "wm-a+dcc": NamedModel(
            "physics with a learned correction, trained with errors of mass and thrust",
            _anchored(wind=False),
        ),
        "wm-u": NamedModel("a learned model without physics", _unanchored),
        "wm-u+dcc": NamedModel(
            "a learned model without physics, trained with errors of mass and thrust", _unanchored
        ),
        "wm-a-wind": NamedModel(
            "physics with a learned correction and a wind input", _anchored(wind=True)
        ),
        "wm-a-nowind": NamedModel(
            "physics with a learned correction, trained in wind that it is not told",
            _anchored(wind=False),
        ),
    }
)

INERTIAL = "dob-inertial"
"""The one that reads a raw sensor: a variant only with a shipped filter, which reads them too."""
RECONSTRUCTIONS: Mapping[str, NamedModel[Reconstruction]] = MappingProxyType(
    {
        "dob": NamedModel(
            "the acceleration that mass, thrust and drag do not explain",
            lambda: DisturbanceObserver(drag_kgps=_DRAG),
        ),
        INERTIAL: NamedModel(
            "the acceleration that mass, thrust and drag do not explain, by the accelerometer",
            lambda: InertialObserver(drag_kgps=_DRAG),
        ),
        "gru": NamedModel(
            "a network that reads recent motion, mass and thrust scale", _recurrent(calibrated=True)
        ),
        "gru+dcc": NamedModel(
            "a network that reads recent motion, mass and thrust scale, and was trained "
            "with errors of both",
            _recurrent(calibrated=True),
        ),
        "gru+state": NamedModel(
            "a network that reads recent motion, mass and thrust scale, and was trained "
            "with errors of motion",
            _recurrent(calibrated=True),
        ),
        "gru-withheld": NamedModel(
            "a network that reads recent motion, and neither mass nor thrust scale",
            _recurrent(calibrated=False),
        ),
        "gru-trajectory": NamedModel(
            "a network that reads recent motion alone, trained on flights of the planner",
            _recurrent(calibrated=False),
        ),
    }
)


def predictor(name: str, seed: int | None, device: torch.device = CPU) -> Predictor:
    """Return a predictor of `PREDICTORS`; `UserError` where a checkpoint is missing."""
    return _loaded(PREDICTORS[name], name, seed, device)


def reconstruction(name: str, seed: int | None, device: torch.device = CPU) -> Reconstruction:
    """Return a reconstruction of `RECONSTRUCTIONS`; `UserError` for a missing checkpoint."""
    return _loaded(RECONSTRUCTIONS[name], name, seed, device)


@lru_cache
def _loaded(kind: NamedModel[Model], name: str, seed: int | None, device: torch.device) -> Model:
    with device:
        return kind.load(name, seed)


@lru_cache
def clearance_model(device: torch.device = CPU) -> ClearanceModel:
    """Return the trained clearance model; `UserError` where its checkpoint is missing."""
    with device:
        model = ClearanceModel()
    fill(model, CLEARANCE, 0)
    return model.eval()
