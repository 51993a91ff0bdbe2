"""What is fitted: one model, its data and its loss, behind one interface."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from torch import LongTensor, Tensor, nn


@dataclass(frozen=True)
class Schedule:
    """How long and by which steps a model is fitted.

    The learning rate is constant. The paper gives the optimiser, the rate, the batch and the
    epochs of each model (Section IV-A and appendix); the weight decay is the default of AdamW's
    authors (Loshchilov and Hutter 2019) as PyTorch has it.
    """

    epochs: int
    batch_size: int = 256
    """Samples in a minibatch; the last one of an epoch takes what is left."""
    learning_rate: float = 1e-3
    optimiser: Literal["adam", "adamw"] = "adamw"
    weight_decay: float = 0.01
    """Decoupled weight decay of AdamW; Adam has none."""
    clip_norm: float | None = None
    """Largest norm of the gradient of a minibatch; None leaves gradients as they are."""


class Task(ABC):
    """One model to be fitted, with a seed.

    `fit` calls `load` first, `module` next, then for each epoch `begin_epoch`, the minibatches'
    `loss` and `validate`. A fit that was cut short goes on at a later epoch in a new process, so
    `begin_epoch` and `loss` may depend on the seed, the epoch and the index, and on nothing that
    earlier epochs left in the task.
    """

    name: str
    """Name of the model, for example `wm-a+dcc`; with the seed it names the checkpoint."""
    seed: int
    schedule: Schedule
    platform: str = ""
    """`PLATFORM.weights_hash` of the model; empty for a task that no platform decides."""

    @abstractmethod
    def load(self) -> None:
        """Read the data; `UserError` when they are missing or damaged."""

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of training samples."""

    @property
    @abstractmethod
    def order_key(self) -> str:
        """Stream of the minibatch order; a baseline and its +DCC variant share it."""

    @abstractmethod
    def module(self) -> nn.Module:
        """Return a freshly initialised model in float32.

        Its weights depend on the seed and the base architecture only, never on the corruption, so
        that a baseline and its +DCC variant start from the same ones.
        """

    @abstractmethod
    def begin_epoch(self, epoch: int) -> None:
        """Prepare an epoch, counted from 0: for example, draw the corruption of all samples."""

    @abstractmethod
    def loss(self, module: nn.Module, index: LongTensor) -> Tensor:
        """Return the mean loss, a scalar, of the training samples `index` `[b]`."""

    @abstractmethod
    def validate(self, module: nn.Module) -> Mapping[str, float]:
        """Return metrics on the validation samples, the main one first.

        Called after each epoch, without gradients and in evaluation mode.
        """

    @abstractmethod
    def describe(self) -> Mapping[str, Any]:
        """Return what decides the result, as JSON values, for the model card.

        A finished model is fitted again when it changes. Two keys have a place of their own in
        the card: `description`, a sentence, and `data_sha256`, a digest for each pool.
        """
