"""What a fit of windows says of itself beyond its card; read without torch."""

from typing import Literal

from faultpath.core.frozen import Frozen
from faultpath.learning.model_card import Card
from faultpath.learning.repair import Repair
from faultpath.loop import TapCount

FORMAT = "faultpath-fit/2"


class Architecture(Frozen):
    """What a module is before it has weights."""

    name: str
    structure: str
    """Its parts as torch shows them, and the numbers that each holds."""
    tensors: dict[str, str]
    """Type and shape of each parameter and buffer."""


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


class Machine(Frozen):
    """What computed a fit: it decides the last bits."""

    torch: str
    faultpath: str
    python: str
    device: str
    threads: int


class FitRecord(Card):
    """The card of a fit of windows.

    Its first loss is that of the first minibatch under correct inputs. `validation` is the loss on
    the other side of the split, under correct inputs and perturbed as in training with errors that
    stay the same; empty without validation windows.
    """

    format: Literal["faultpath-fit/2"] = FORMAT
    repairs: tuple[Repair, ...]
    """As they act, every consumer and default spelled out; none for a baseline."""
    reads: tuple[str, ...]
    """The taps `channel -> module.place` of the module."""
    architecture: Architecture
    data: Data
    loss: str
    """Name of what was minimised."""
    order_sha256: tuple[str, ...]
    """Of the order of the training windows in each epoch."""
    taps: tuple[TapCount, ...]
    """What each tap did over all epochs, summed over windows."""
    machine: Machine

    @property
    def repair(self) -> str:
        """The repairs in words."""
        return "; ".join(each.words for each in self.repairs) or "none"
