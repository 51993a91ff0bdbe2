"""Shipped parts by name, with their trained weights and the cards that say where they come from."""

from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import TypeVar

import torch
from pydantic import JsonValue
from torch import nn

from faultpath.plugin.system import UserError
from faultpath.plugin.training import Card, fill
from faultpath_quadrotor.choices import INERTIAL, Fixes
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.estimators import ErrorStateFilter, Estimator
from faultpath_quadrotor.estimators.kalman import Trust
from faultpath_quadrotor.estimators.sensors import sensors
from faultpath_quadrotor.perception import ClearanceModel
from faultpath_quadrotor.platform import CLEARANCE, PLATFORM
from faultpath_quadrotor.predictors import (
    AnchoredPredictor,
    KinematicIntegrator,
    Predictor,
    TrueParameter,
    UnanchoredNetwork,
    UnanchoredPredictor,
)
from faultpath_quadrotor.reconstruction import (
    DisturbanceObserver,
    InertialObserver,
    Reconstruction,
    RecurrentReconstruction,
    WindNetwork,
)

FORMAT = "faultpath-model/1"
Model = TypeVar("Model", Predictor, Reconstruction)


class ModelCard(Card):
    """The card of a fitted model."""

    format: str = FORMAT
    description: str
    samples: int
    """Training samples in an epoch."""
    data_sha256: dict[str, JsonValue]
    """Digest of each pool of data."""
    config: dict[str, JsonValue]
    """Everything else that the task describes."""
    order_key: str
    """Stream of the minibatch order."""
    platform: str
    """`PLATFORM.weights_hash` of the platform that the data were made for."""
    torch_version: str
    faultpath_version: str

    @property
    def final(self) -> dict[str, float]:
        """Validation metrics of the weights, the main one first."""
        return self.validation[-1]


def shipped_folder() -> Path:
    """Return the folder of the checkpoints that come with the package."""
    return Path(str(files("faultpath_quadrotor"))) / "checkpoints"


def checkpoint_path(name: str, seed: int) -> Path:
    """Return the shipped weights file of a model; `UserError` without it."""
    path = shipped_folder() / f"{name}-{seed}.safetensors"
    if not path.is_file():
        raise UserError(
            f"there is no checkpoint of '{name}' with seed {seed} in {path.parent}: "
            f"`faultpath train quadrotor {name} --seed {seed} --ship` makes it."
        )
    return path


def blank_predictor(name: str) -> Predictor:
    """Return a predictor of `choices.PREDICTORS` with blank weights, if it has any."""
    drag_kgps = PLATFORM.drag_kgps
    match name.removesuffix("+dcc"):
        case "dki" | "dki-drag":
            return KinematicIntegrator(name == "dki-drag", drag_kgps=drag_kgps)
        case "true-parameter":
            return TrueParameter()
        case "wm-u":
            return UnanchoredPredictor(UnanchoredNetwork())
        case _:
            network = AnchoredPredictor.build_network()
            return AnchoredPredictor(network, name == "wm-a-wind", drag_kgps)


def blank_reconstruction(name: str) -> Reconstruction:
    """Return a reconstruction of `choices.RECONSTRUCTIONS` with blank weights, if it has any."""
    if name in ("dob", INERTIAL):
        observer = DisturbanceObserver if name == "dob" else InertialObserver
        return observer(PLATFORM.drag_kgps)
    calibrated = name not in ("gru-withheld", "gru-trajectory")
    return RecurrentReconstruction(WindNetwork(calibrated))


@lru_cache
def predictor(name: str, seed: int | None, device: torch.device = CPU) -> Predictor:
    """Return a predictor as trained with a seed, blank for `None`; raises as `_fill`."""
    with device:
        return _trained(blank_predictor(name), name, seed)


@lru_cache
def reconstruction(name: str, seed: int | None, device: torch.device = CPU) -> Reconstruction:
    """Return a reconstruction as trained with a seed, blank for `None`; raises as `_fill`."""
    with device:
        return _trained(blank_reconstruction(name), name, seed)


@lru_cache
def clearance_model(device: torch.device = CPU) -> ClearanceModel:
    """Return the trained clearance model; raises as `_fill`."""
    with device:
        model = ClearanceModel()
    _fill(model, CLEARANCE, 0)
    return model.eval()


def estimator(name: str, fixes: Fixes = Fixes.OPTICAL, device: torch.device = CPU) -> Estimator:
    """Return an estimator of `choices.ESTIMATORS`; `KeyError` for any other name."""
    settings = {"eskf": (True, 1.0), "eskf-no-bias": (False, 1.0), "eskf-cautious": (True, 3.0)}
    biases, doubt = settings[name]
    return ErrorStateFilter(Trust(sensors(fixes), biases, doubt), device)


def _trained(model: Model, name: str, seed: int | None) -> Model:
    network = getattr(model, "network", None)
    if seed is not None and network is not None:
        _fill(network, name, seed)
    return model


def _fill(network: nn.Module, name: str, seed: int) -> None:
    """Fill a network with its shipped weights.

    Raises `UserError` where they are missing, cannot be read, or were fitted for another platform.
    """
    platform = PLATFORM.weights_hash(name)
    card = fill(network, checkpoint_path(name, seed), ModelCard)
    if card.platform != platform:
        raise UserError(
            f"the weights of {card.stem} were fitted for another platform ({card.platform}) than "
            f"the one that is flown ({platform}): fit them again"
        )
