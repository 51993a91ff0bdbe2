"""A module's weights: their digest, their file, and what the module is without them."""

from __future__ import annotations

import json
import platform
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.repairs.code import code_sha256, name_of, plain_fields
from faultpath.repairs.record import Architecture, FitRecord, Machine, read_record
from faultpath.store.atomic import make_folder, write_file, write_text
from faultpath.text import extra
from faultpath.version import __version__

if TYPE_CHECKING:
    from torch import nn


def save(net: nn.Module, record: FitRecord, folder: Path) -> Path:
    """Write weights and, last, their record; each file is whole or absent."""
    make_folder(folder)
    path = folder / f"{record.stem}.safetensors"
    write_file(path, _encoded(net))
    text = json.dumps(record.model_dump(mode="json"), indent=2, allow_nan=False)
    write_text(path.with_suffix(".json"), f"{text}\n")
    return path


def fill(net: nn.Module, path: Path) -> FitRecord:
    """Fill a module with the weights of a fit and return their record.

    Raises `UserError` when a file is missing, differs from its record, or is of another
    architecture.
    """
    record = read_record(path)
    try:
        content = contents(path)
    except OSError as error:
        raise UserError(f"cannot read {path} ({error.strerror}): fit the module again") from error
    if sha256(content).hexdigest() != record.weights_sha256:
        raise UserError(
            f"the weights in {path} are not those of their record: copy both files again or fit "
            "the module again"
        )
    try:
        net.load_state_dict(_safetensors().load(content))
    except RuntimeError as error:
        raise UserError(
            f"the weights in {path} are of another architecture than {name_of(net)}: give the "
            "module that was fitted"
        ) from error
    return record


def weights_sha256(net: nn.Module) -> str:
    """Return the digest of the file that the weights would make."""
    return sha256(_encoded(net)).hexdigest()


def architecture(net: nn.Module) -> Architecture:
    """Return what a module is before it has weights."""
    parts = {place or name_of(net): part for place, part in net.named_modules()}
    held = {place: plain_fields(part) for place, part in parts.items()}
    lines = [f"{p}: { {k: v for k, v in f.items() if k != 'training'} }" for p, f in held.items()]
    return Architecture(
        name=name_of(net),
        structure="\n".join((str(net), *lines)),
        tensors={
            name: f"{str(value.dtype).removeprefix('torch.')} {list(value.shape)}"
            for name, value in net.state_dict().items()
        },
        code_sha256=code_sha256([type(part) for part in parts.values()]),
    )


def machine(device: str) -> Machine:
    """Return what computes here."""
    import torch

    return Machine(
        torch=torch.__version__,
        faultpath=__version__,
        python=".".join(platform.python_version_tuple()[:2]),
        device=device,
        threads=torch.get_num_threads(),
    )


def _encoded(net: nn.Module) -> bytes:
    state = net.state_dict().items()
    return _safetensors().save({name: value.detach().cpu().clone() for name, value in state})


def _safetensors() -> Any:
    try:
        import safetensors.torch
    except ModuleNotFoundError as error:
        raise UserError(
            f"fits are kept as safetensors, which is not installed: {extra('torch')}"
        ) from error
    return safetensors.torch
