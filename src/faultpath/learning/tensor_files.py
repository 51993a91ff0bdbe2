"""Files of tensors with a note: safetensors, so that reading one runs no code."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.core.errors import UserError
from faultpath.core.files.opening import opened
from faultpath.core.files.plain import Misread
from faultpath.core.text import extra

if TYPE_CHECKING:
    from torch import Tensor

_ENTRY = "note"  # only one entry, since the order of several in a file is not fixed


def encoded(tensors: Mapping[str, Tensor], note: object = None) -> bytes:
    """Return the bytes of a file of tensors and a JSON value, which depend on these alone."""
    from torch import contiguous_format as rows  # safetensors takes no other order

    own = {name: value.detach().cpu().clone(memory_format=rows) for name, value in tensors.items()}
    return safetensors().save(own, None if note is None else {_ENTRY: json.dumps(note)})


def read_note(path: Path) -> Any:
    """Return the note of a file, `None` without one; raises as `read_tensors`."""
    return _read(path, tensors=False)[0]


def read_tensors(path: Path) -> tuple[Any, dict[str, Tensor]]:
    """Return the note and the tensors of a file; `OSError`, or `Misread` for a damaged one."""
    return _read(path, tensors=True)


def _read(path: Path, tensors: bool) -> tuple[Any, dict[str, Tensor]]:
    safetensors()
    from safetensors import SafetensorError, safe_open

    opened(path).close()
    try:
        with safe_open(path, framework="pt") as file:
            note = json.loads((file.metadata() or {}).get(_ENTRY, "null"))
            names = list(file.keys()) if tensors else []
            return note, {name: file.get_tensor(name).clone() for name in names}
    except (SafetensorError, ValueError) as error:
        raise Misread("is damaged, or no file of tensors") from error


def safetensors() -> Any:
    """Return the module that writes tensors; `UserError` where it is not installed."""
    try:
        import safetensors.torch
    except ModuleNotFoundError as error:
        raise UserError(
            f"fits are kept as safetensors, which is not installed: {extra('torch')}"
        ) from error
    return safetensors.torch
