"""Weights of fitted models and the cards that say where they come from."""

import hashlib
import json
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, JsonValue, ValidationError
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor, nn

from faultpath.errors import UserError
from faultpath.store.atomic import write

FORMAT = "faultpath-model/1"


class ModelCard(BaseModel):
    """Where the weights of one model come from and how good they are.

    It is `<stem>.json` beside `<stem>.safetensors`. Only `weights_sha256` identifies the model:
    durations and versions differ between fits that gave the same weights.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: str = FORMAT
    name: str
    seed: int
    description: str
    parameters: int
    """Numbers that were fitted; constants such as the scales of the inputs do not count."""
    samples: int
    """Training samples in an epoch."""
    schedule: dict[str, JsonValue]
    data_sha256: dict[str, JsonValue]
    """Digest of each pool of data."""
    config: dict[str, JsonValue]
    """Everything else the task says of itself."""
    order_key: str
    """Stream of the minibatch order."""
    initial_sha256: str
    """Digest of the model before its first step."""
    first_loss: float
    """Loss of the first minibatch before the first step."""
    training_loss: tuple[float, ...]
    """Mean over the minibatches of each epoch."""
    validation: tuple[dict[str, float], ...]
    """Metrics after each epoch."""
    weights_sha256: str
    """Digest of the weights file."""
    duration_s: float
    """Time spent in epochs, all processes together."""
    torch_version: str
    faultpath_version: str

    @property
    def stem(self) -> str:
        """Name of the files without their ending."""
        return stem(self.name, self.seed)

    @property
    def final(self) -> dict[str, float]:
        """Validation metrics of the weights, the main one first."""
        return self.validation[-1]


def stem(name: str, seed: int) -> str:
    """Return the file name of a model without its ending, for example `wm-a+dcc-0`."""
    return f"{name}-{seed}"


def shipped_folder() -> Path:
    """Return the folder of the checkpoints that come with the package."""
    return Path(str(files("faultpath.quadrotor"))) / "checkpoints"


def checkpoint_path(name: str, seed: int, folder: Path | None = None) -> Path:
    """Return the weights file of a model, by default among those of the package.

    Raises `UserError` when it is not there.
    """
    path = (folder or shipped_folder()) / f"{stem(name, seed)}.safetensors"
    if not path.is_file():
        place = "with the package" if folder is None else f"in {folder}"
        raise UserError(
            f"there is no checkpoint of '{name}' with seed {seed} {place}: "
            f"`faultpath train quadrotor {name} --seed {seed} --ship` makes it."
        )
    return path


def read_card(path: Path) -> ModelCard:
    """Read the card beside a weights file; `UserError` when it is missing or damaged."""
    card = path.with_suffix(".json")
    try:
        return ModelCard.model_validate_json(card.read_bytes())
    except (OSError, ValidationError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no model card"
        raise UserError(
            f"cannot read the model card {card} ({reason}): copy it again or fit the model again."
        ) from error


def load_checkpoint(module: nn.Module, path: Path) -> ModelCard:
    """Fill a module with the weights of a file and return their card.

    Raises `UserError` when the file is missing, differs from what its card describes, or belongs
    to another architecture.
    """
    card = read_card(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): copy it again or fit the model again."
        ) from error
    if digest(data) != card.weights_sha256:
        raise UserError(
            f"the weights in {path} are not those of its card: copy both files again or fit the "
            "model again."
        )
    try:
        module.load_state_dict(load(data))
    except (RuntimeError, SafetensorError) as error:
        raise UserError(
            f"the weights in {path} are of another architecture than this version builds: fit the "
            "model again."
        ) from error
    return card


def save_checkpoint(module: nn.Module, path: Path, card: Mapping[str, Any]) -> ModelCard:
    """Write the weights, then the card with their digest; each file is whole or absent.

    `card` holds the fields of `ModelCard` that the module does not know: all but `parameters` and
    `weights_sha256`. The bytes of the weights file depend on the weights alone.
    """
    data = save(tensors(module))
    full = ModelCard(
        parameters=parameter_count(module),
        weights_sha256=digest(data),
        **card,
    )
    write(path, data)
    text = json.dumps(full.model_dump(mode="json"), indent=2, allow_nan=False)
    write(path.with_suffix(".json"), f"{text}\n".encode())
    return full


def ship(path: Path) -> None:
    """Copy a checkpoint and its card into the package; `UserError` when that is not writable."""
    folder = shipped_folder()
    try:
        folder.mkdir(exist_ok=True)
        for each in (path, path.with_suffix(".json")):
            write(folder / each.name, each.read_bytes())
    except OSError as error:
        raise UserError(
            f"cannot ship {path.stem} into {folder} ({error.strerror}): install the package so "
            "that you may write to it, or leave --ship out."
        ) from error


def digest(data: bytes) -> str:
    """Return the SHA-256 of some bytes in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def tensors(module: nn.Module) -> dict[str, Tensor]:
    """Return parameters and buffers by name, each with memory of its own."""
    return {name: value.detach().clone() for name, value in module.state_dict().items()}


def parameter_count(module: nn.Module) -> int:
    """Return how many numbers are fitted."""
    return sum(each.numel() for each in module.parameters() if each.requires_grad)
