"""What can stand at each place of the controller, by name, and its trained weights."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Generic, TypeVar

import torch
from torch import nn

from faultpath.errors import UserError
from faultpath.quadrotor.checkpoint import checkpoint_path, load_checkpoint, shipped_folder
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.perception import ClearanceModel
from faultpath.quadrotor.platform import CLEARANCE, Platform
from faultpath.quadrotor.platforms import DEFAULT, name_of
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
class Shelf:
    """Where trained weights are taken from: those of a platform."""

    platform: Platform = DEFAULT
    folder: Path | None = None
    """`None`: the package's folder of the platform."""

    @property
    def place(self) -> Path:
        """The folder; `UserError` for a platform that is not frozen and brings no folder."""
        if self.folder is not None:
            return self.folder
        name = name_of(self.platform)
        if name is None:
            raise UserError(
                f"the platform {self.platform.hash} is not one of the package's: name the folder "
                "of the models that were fitted for it"
            )
        return shipped_folder(name)

    def fill(self, network: nn.Module, name: str, seed: int) -> None:
        """Fill a network with its weights; `UserError` where they are missing or of another
        platform."""
        wanted = self.platform.weights_hash(name)
        path = checkpoint_path(name, seed, self.place)
        card = load_checkpoint(network, path)
        if card.platform != wanted:
            raise UserError(
                f"the weights of {card.stem} in {path.parent} were fitted for another platform "
                f"({card.platform}) than the one that is flown ({wanted}): fit them again for "
                "this one, or name the folder of its own"
            )


PACKAGE = Shelf()
"""The shipped weights of the first platform."""


@dataclass(frozen=True)
class Kind(Generic[Model]):
    """A predictor or a wind reconstruction by name."""

    description: str
    build: Callable[[Platform], Model]
    """Makes it, with blank weights where it has any: enough to know what it reads."""

    def load(self, name: str, seed: int | None, shelf: Shelf) -> Model:
        """Return it as trained with a seed; blank for `None`.

        Raises `UserError` where there is no checkpoint, it cannot be read, or is of another
        platform.
        """
        made = self.build(shelf.platform)
        if seed is not None and isinstance(made, _LEARNED):
            shelf.fill(made.network, name, seed)
        return made


_LEARNED = (AnchoredPredictor, UnanchoredPredictor, RecurrentReconstruction)


def _integrator(drag: bool) -> Callable[[Platform], Predictor]:
    return lambda platform: KinematicIntegrator(drag, drag_kgps=platform.drag_kgps)


def _anchored(wind: bool) -> Callable[[Platform], Predictor]:
    network = AnchoredPredictor.build_network
    return lambda platform: AnchoredPredictor(network(), wind, platform.drag_kgps)


def _unanchored(platform: Platform) -> Predictor:
    del platform
    return UnanchoredPredictor(UnanchoredPredictor.build_network())


def _recurrent(calibrated: bool) -> Callable[[Platform], Reconstruction]:
    return lambda platform: RecurrentReconstruction(WindNetwork(calibrated))


PREDICTORS: Mapping[str, Kind[Predictor]] = MappingProxyType(
    {
        "dki": Kind("physics without drag", _integrator(drag=False)),
        "dki-drag": Kind("physics with nominal drag", _integrator(drag=True)),
        "true-parameter": Kind(
            "the simulator's physics and parameters",
            lambda platform: TrueParameter(platform.follows_motors),
        ),
        "wm-a": Kind("physics with a learned correction", _anchored(wind=False)),
        "wm-a+dcc": Kind(
            "physics with a learned correction, trained with errors of mass and thrust",
            _anchored(wind=False),
        ),
        "wm-u": Kind("a learned model without physics", _unanchored),
        "wm-u+dcc": Kind(
            "a learned model without physics, trained with errors of mass and thrust", _unanchored
        ),
        "wm-a-wind": Kind(
            "physics with a learned correction and a wind input", _anchored(wind=True)
        ),
        "wm-a-nowind": Kind(
            "physics with a learned correction, trained in wind that it is not told",
            _anchored(wind=False),
        ),
    }
)

RECONSTRUCTIONS: Mapping[str, Kind[Reconstruction]] = MappingProxyType(
    {
        "dob": Kind(
            "the acceleration that mass, thrust and drag do not explain",
            lambda platform: DisturbanceObserver(drag_kgps=platform.drag_kgps),
        ),
        "gru": Kind(
            "a network that reads recent motion, mass and thrust scale", _recurrent(calibrated=True)
        ),
        "gru+dcc": Kind(
            "a network that reads recent motion, mass and thrust scale, and was trained "
            "with errors of both",
            _recurrent(calibrated=True),
        ),
        "gru-withheld": Kind(
            "a network that reads recent motion, and neither mass nor thrust scale",
            _recurrent(calibrated=False),
        ),
        "gru-trajectory": Kind(
            "a network that reads recent motion alone, trained on flights of the planner",
            _recurrent(calibrated=False),
        ),
    }
)


def predictor(
    name: str, seed: int | None, device: torch.device = CPU, shelf: Shelf = PACKAGE
) -> Predictor:
    """Return a predictor of `PREDICTORS`; `UserError` where a checkpoint is missing."""
    return _predictor(name, seed, device, shelf)


def reconstruction(
    name: str, seed: int | None, device: torch.device = CPU, shelf: Shelf = PACKAGE
) -> Reconstruction:
    """Return a reconstruction of `RECONSTRUCTIONS`; `UserError` for a missing checkpoint."""
    return _reconstruction(name, seed, device, shelf)


def clearance_model(device: torch.device = CPU, shelf: Shelf = PACKAGE) -> ClearanceModel:
    """Return the trained clearance model; `UserError` where its checkpoint is missing."""
    return _clearance_model(device, shelf)


@lru_cache
def _predictor(name: str, seed: int | None, device: torch.device, shelf: Shelf) -> Predictor:
    with device:
        return PREDICTORS[name].load(name, seed, shelf)


@lru_cache
def _reconstruction(
    name: str, seed: int | None, device: torch.device, shelf: Shelf
) -> Reconstruction:
    with device:
        return RECONSTRUCTIONS[name].load(name, seed, shelf)


@lru_cache
def _clearance_model(device: torch.device, shelf: Shelf) -> ClearanceModel:
    with device:
        model = ClearanceModel()
    shelf.fill(model, CLEARANCE, 0)
    return model.eval()
