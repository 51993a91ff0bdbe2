"""Weights of fitted models, each beside the card that says where they come from."""

import hashlib
import json
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor, nn

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.quadrotor.card import ModelCard, read_card, stem
from faultpath.store.atomic import write


def shipped_folder() -> Path:
    """Return the folder of the checkpoints that come with the package."""
    return Path(str(files("faultpath.quadrotor"))) / "checkpoints"


def checkpoint_path(name: str, seed: int, folder: Path | None = None) -> Path:
    """Return the weights file of a model, by default the shipped one; `UserError` without it."""
    shipped = shipped_folder()
    folder = folder or shipped
    path = folder / f"{stem(name, seed)}.safetensors"
    if not path.is_file():
        how = "--ship" if folder == shipped else f"--out {folder}"
        raise UserError(
            f"there is no checkpoint of '{name}' with seed {seed} in {folder}: "
            f"`faultpath train quadrotor {name} --seed {seed} {how}` makes it."
        )
    return path


def load_checkpoint(module: nn.Module, path: Path) -> ModelCard:
    """Fill a module with the weights of a file and return their card.

    Raises `UserError` when the file is missing, differs from what its card describes, or belongs
    to another architecture.
    """
    card = read_card(path)
    try:
        data = contents(path)
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
        folder.mkdir(parents=True, exist_ok=True)
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
