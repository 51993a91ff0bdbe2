"""What a fit says of itself, in a file beside its weights; read without torch."""

from pathlib import Path
from typing import Literal

from pydantic import Field

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.files.plain import Misread, model_of
from faultpath.frozen import Frozen
from faultpath.repairs.repair import Repair
from faultpath.taps import TapCount

FORMAT = "faultpath-fit/1"


class Schedule(Frozen, allow_inf_nan=False):
    """How long and by which steps a module is fitted; the learning rate is constant."""

    epochs: int = Field(default=10, ge=1, le=90_000)
    batch_size: int = Field(default=64, ge=1)
    """Windows in a minibatch; the last one of an epoch takes what is left."""
    learning_rate: float = Field(default=1e-3, gt=0)
    optimiser: Literal["adam", "adamw"] = "adamw"
    weight_decay: float = Field(default=0.01, ge=0)
    """Decoupled weight decay of AdamW; Adam has none."""
    clip_norm: float | None = Field(default=None, gt=0)
    """Largest norm of the gradient of a minibatch; `None` leaves gradients as they are."""


class Architecture(Frozen):
    """What a module is before it has weights."""

    name: str
    structure: str
    """Its parts as torch shows them, and the numbers that each holds."""
    tensors: dict[str, str]
    """Type and shape of each parameter and buffer."""
    code_sha256: str
    """Of the user's own classes in it."""


class Data(Frozen):
    """What was fitted to, in digests."""

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
    """Of their names."""


class Loss(Frozen):
    """What was minimised."""

    name: str
    code_sha256: str


class Machine(Frozen):
    """What computed a fit: it decides the last bits, and whether code can be compared."""

    torch: str
    faultpath: str
    python: str
    device: str
    threads: int


class FitRecord(Frozen):
    """Where the weights of one fit come from: `<name>-<seed>.json` beside its weights."""

    format: Literal["faultpath-fit/1"] = FORMAT
    name: str
    seed: int
    repairs: tuple[Repair, ...]
    """As they struck, every consumer and default spelled out; none for a baseline."""
    reads: tuple[str, ...]
    """The taps `channel -> module.place` of the module."""
    architecture: Architecture
    parameters: int
    """Numbers that were fitted."""
    data: Data
    loss: Loss
    schedule: Schedule
    initial_sha256: str
    """Of the weights before the first step."""
    initial_loss: float
    """Of the first minibatch under correct inputs, before the first step."""
    order_sha256: tuple[str, ...]
    """Of the order of the training windows in each epoch."""
    training_loss: tuple[float, ...]
    """Mean over the windows of each epoch."""
    validation: tuple[dict[str, float], ...]
    """Loss after each epoch on the other side of the split: under correct inputs, and perturbed as
    in training with errors that stay the same. Empty without validation windows."""
    taps: tuple[TapCount, ...]
    """What each tap did over all epochs, summed over windows."""
    weights_sha256: str
    machine: Machine
    duration_s: float

    @property
    def stem(self) -> str:
        """Name of the files without their ending."""
        return f"{self.name}-{self.seed}"

    @property
    def repair(self) -> str:
        """The repairs in words."""
        return "; ".join(each.words for each in self.repairs) or "none"


def read_record(path: Path) -> FitRecord:
    """Read the record beside a weights file; `UserError` when it is missing or damaged."""
    place = path.with_suffix(".json")
    try:
        return model_of(contents(place), FitRecord)
    except (OSError, Misread) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no record of a fit"
        raise UserError(
            f"cannot read {place} ({reason}): copy it again or fit the module again"
        ) from error
