"""Weights of the quadrotor's fitted models, each beside the card that says where they come from."""

from importlib.resources import files
from pathlib import Path

from pydantic import JsonValue

from faultpath.plugin.system import UserError
from faultpath.plugin.training import Card

FORMAT = "faultpath-model/1"


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
