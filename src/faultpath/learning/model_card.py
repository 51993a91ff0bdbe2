"""Files of a fitted module: its weights, and a card with their origin.

A card is read without torch. Files of tensors are safetensors: reading them runs no code.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

from pydantic import Field

from faultpath.core import __version__
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_file, write_text
from faultpath.core.files.opening import contents, opened
from faultpath.core.files.plain import Misread, model_of
from faultpath.core.results import Frozen
from faultpath.core.text import extra
from faultpath.learning.repair import Repair
from faultpath.loop import TapCount

if TYPE_CHECKING:
    from torch import Tensor, nn

_ENTRY = "note"  # only one entry, since the order of several in a file is not fixed


class Schedule(Frozen, allow_inf_nan=False):
    """Epochs, minibatches and optimiser of a fit; the learning rate is constant."""

    epochs: int = Field(default=10, ge=1, le=90_000)
    batch_size: int = Field(default=64, ge=1)
    """Samples of a minibatch; the last one of an epoch may have fewer."""
    learning_rate: float = Field(default=1e-3, gt=0)
    optimiser: Literal["adam", "adamw"] = "adamw"
    weight_decay: float = Field(default=0.01, ge=0)
    """Decoupled weight decay of AdamW; Adam has none."""
    clip_norm: float | None = Field(default=None, gt=0)
    """Largest norm of the gradient of a minibatch; `None` leaves gradients as they are."""


class Card(Frozen):
    """Origin of the weights of one fit: `<name>-<seed>.json` beside its weights.

    Only `weights_sha256` identifies the weights: durations and versions differ between fits that
    gave the same ones.
    """

    name: str
    seed: int
    parameters: int
    """Number of fitted parameters."""
    schedule: Schedule
    initial_sha256: str
    """Digest of the weights before the first step."""
    first_loss: float
    """Loss of the first minibatch before the first step, by which the code can be compared."""
    training_loss: tuple[float, ...]
    """Mean over the samples of each epoch."""
    validation: tuple[dict[str, float], ...]
    """Metrics after each epoch."""
    weights_sha256: str
    duration_s: float

    @property
    def stem(self) -> str:
        """Name of the files without their ending."""
        return f"{self.name}-{self.seed}"


class Architecture(Frozen):
    """Structure of a module, without its weights."""

    name: str
    structure: str
    """Its parts as torch prints them, and the constants of each."""
    tensors: dict[str, str]
    """Type and shape of each parameter and buffer."""

    @classmethod
    def of(cls, net: nn.Module) -> Self:
        """Return the architecture of a module."""
        structure = [str(net)]
        for name_in_net, part in net.named_modules():
            plain = {
                name: value
                for name, value in sorted(vars(part).items())
                if isinstance(value, bool | int | float | str | tuple) and name != "training"
            }
            structure.append(f"{name_in_net or type(net).__name__}: {plain}")
        tensors = {
            name: f"{str(value.dtype).removeprefix('torch.')} {list(value.shape)}"
            for name, value in net.state_dict().items()
        }
        return cls(name=type(net).__name__, structure="\n".join(structure), tensors=tensors)


class Data(Frozen):
    """The windows of a fit, in digests."""

    readings_sha256: dict[str, str]
    """By channel."""
    targets_sha256: dict[str, str]
    ids_sha256: str
    windows: int
    steps: int | None
    dt_s: float
    training: int
    """Windows on the training side of the split."""
    training_sha256: str
    """Digest of their names."""


class Machine(Frozen):
    """Software and device of a fit, on which the last bits depend."""

    torch: str
    faultpath: str
    python: str
    device: str
    threads: int

    @classmethod
    def here(cls, device: str) -> Self:
        """Return this machine, fitting on a torch device of this type."""
        import torch

        return cls(
            torch=torch.__version__,
            faultpath=__version__,
            python=".".join(platform.python_version_tuple()[:2]),
            device=device,
            threads=torch.get_num_threads(),
        )


class FitRecord(Card):
    """The card of a fit of windows.

    Its first loss is that of the first minibatch under correct inputs. `validation` is the loss on
    the validation windows, under correct inputs and perturbed as in training, with the same errors
    in every epoch; empty without such windows.
    """

    format: Literal["faultpath-fit/2"] = "faultpath-fit/2"
    repairs: tuple[Repair, ...]
    """Repairs with all readers and defaults spelled out; none for a baseline."""
    reads: tuple[str, ...]
    """The taps `channel -> module.place` of the module."""
    architecture: Architecture
    data: Data
    loss: str
    """Name of the loss function."""
    order_sha256: tuple[str, ...]
    """Digest of the order of the training windows in each epoch."""
    taps: tuple[TapCount, ...]
    """Counts of each tap over all epochs, summed over windows."""
    machine: Machine

    @property
    def repair(self) -> str:
        """The repairs in words."""
        return "; ".join(repair.words for repair in self.repairs) or "none"


CardKind = TypeVar("CardKind", bound=Card)


def read_card(path: Path, kind: type[CardKind]) -> CardKind:
    """Read the card beside a weights file; `UserError` when it is missing or damaged."""
    card_path = path.with_suffix(".json")
    try:
        return model_of(contents(card_path), kind)
    except (OSError, Misread) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no card of a fit"
        raise UserError(
            f"cannot read {card_path} ({reason}): copy it again or fit the model again"
        ) from error


def save(net: nn.Module, card: Card, folder: Path) -> Path:
    """Write weights and, last, their card; each file is whole or absent. Return the weights' path.

    The bytes of the weights file depend on the weights alone.
    """
    path = folder / f"{card.stem}.safetensors"
    write_file(path, encoded(net.state_dict()))
    text = json.dumps(card.model_dump(mode="json"), indent=2, allow_nan=False)
    write_text(path.with_suffix(".json"), f"{text}\n")
    return path


def fill(net: nn.Module, path: Path, kind: type[CardKind]) -> CardKind:
    """Fill a module with the weights of a fit and return their card.

    Raises `UserError` when a file is missing, differs from its card, or is of another architecture.
    """
    card = read_card(path, kind)
    try:
        content = contents(path)
    except OSError as error:
        raise UserError(f"cannot read {path} ({error.strerror}): fit the model again") from error
    if sha256(content).hexdigest() != card.weights_sha256:
        raise UserError(
            f"the weights in {path} are not those of its card: copy both files again or fit the "
            "model again"
        )
    codec = _safetensors()
    from safetensors import SafetensorError

    try:
        net.load_state_dict(codec.load(content))
    except (RuntimeError, SafetensorError) as error:
        raise UserError(
            f"the weights in {path} are of another architecture than {type(net).__name__}: give "
            "the module that was fitted, or fit the model again"
        ) from error
    return card


def weights_sha256(net: nn.Module) -> str:
    """Return the digest of the weights' file."""
    return sha256(encoded(net.state_dict())).hexdigest()


def parameter_count(net: nn.Module) -> int:
    """Return the number of fitted parameters."""
    return sum(weight.numel() for weight in net.parameters() if weight.requires_grad)


def encoded(tensors: Mapping[str, Tensor], note: object = None) -> bytes:
    """Return the bytes of a file of tensors and a JSON value, which depend on these alone."""
    from torch import contiguous_format as rows  # safetensors takes no other order

    own = {name: value.detach().cpu().clone(memory_format=rows) for name, value in tensors.items()}
    return _safetensors().save(own, None if note is None else {_ENTRY: json.dumps(note)})


def read_note(path: Path) -> Any:
    """Return the note of a file, `None` without one; raises as `read_tensors`."""
    return _read(path, tensors=False)[0]


def read_tensors(path: Path) -> tuple[Any, dict[str, Tensor]]:
    """Return the note and the tensors of a file; `OSError`, or `Misread` for a damaged one."""
    return _read(path, tensors=True)


def _read(path: Path, tensors: bool) -> tuple[Any, dict[str, Tensor]]:
    _safetensors()
    from safetensors import SafetensorError, safe_open

    opened(path).close()
    try:
        with safe_open(path, framework="pt") as file:
            note = json.loads((file.metadata() or {}).get(_ENTRY, "null"))
            names = list(file.keys()) if tensors else []
            return note, {name: file.get_tensor(name).clone() for name in names}
    except (SafetensorError, ValueError) as error:
        raise Misread("is damaged, or no file of tensors") from error


def _safetensors() -> Any:
    """Return the module that writes tensors; `UserError` where it is not installed."""
    try:
        import safetensors.torch
    except ModuleNotFoundError as error:
        raise UserError(
            f"fits are kept as safetensors, which is not installed: {extra('torch')}"
        ) from error
    return safetensors.torch
