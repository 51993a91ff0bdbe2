"""The fitting loop: epochs of minibatches, resumable to the bit.

Laws. The order of minibatches depends on the task's `order_key` and its seed only. A fit that was
killed and resumed from its journal ends with the same weights as an uninterrupted one.
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.core.errors import UserError
from faultpath.core.files.atomic import write_file
from faultpath.core.files.plain import Misread
from faultpath.core.streams import generator
from faultpath.learning.model_card import Schedule, encoded, read_tensors

if TYPE_CHECKING:
    from torch import LongTensor, Tensor, nn
    from torch.optim import Optimizer


class Diverged(UserError):
    """A fit is no longer finite; a journal keeps the state after its last good epoch."""


@dataclass(frozen=True)
class FitProgress:
    """Progress of a fit."""

    epoch: int
    """Present epoch, counted from 0."""
    fraction: float
    """Finished part of all minibatches."""
    loss: float
    """Loss of the last minibatch."""


@dataclass(frozen=True)
class History:
    """Losses and metrics of the epochs so far, one entry an epoch."""

    training_loss: tuple[float, ...] = ()
    validation: tuple[dict[str, float], ...] = ()
    duration_s: float = 0.0


class FitTask(ABC):
    """The samples of a fit and their loss.

    For each epoch `begin_epoch`, the minibatches' `loss` and `validate` are called. An interrupted
    fit resumes at a later epoch in a new process, so `begin_epoch` and `loss` may depend on seed,
    epoch and index, but not on state that earlier epochs left in the task.
    """

    name: str
    """Name of the model, for example `wm-a+dcc`; with the seed it names the files."""
    seed: int
    schedule: Schedule
    count: int
    """Number of training samples."""
    order_key: str
    """Stream of the minibatch order; a baseline and its repair share it."""

    def begin_epoch(self, epoch: int) -> None:
        """Prepare an epoch, counted from 0: for example, draw the errors of all samples."""
        del epoch

    @abstractmethod
    def loss(self, net: nn.Module, index: LongTensor) -> Tensor:
        """Return the mean loss, a scalar, of the training samples `index` `[b]`."""

    @abstractmethod
    def validate(self, net: nn.Module) -> Mapping[str, float]:
        """Return metrics on the validation samples, the main one first.

        Called after each epoch, without gradients and in evaluation mode.
        """


@dataclass(frozen=True)
class Journal:
    """State of an unfinished fit: one file, written whole after every epoch.

    It holds everything on which the next epoch depends. Random numbers are addressed by the epoch,
    so there is no random state to store.
    """

    path: Path
    recipe: Mapping[str, Any]
    """JSON values on which the fit depends; a journal of another recipe is not used."""

    def write(self, net: nn.Module, optimiser: Optimizer, history: History) -> None:
        """Write weights, moments and step counts of the optimiser, and the history."""
        state = {f"model.{name}": value for name, value in net.state_dict().items()}
        for number, moments in optimiser.state_dict()["state"].items():
            state |= {f"optimiser.{number}.{name}": value for name, value in moments.items()}
        write_file(self.path, encoded(state, {"recipe": self.recipe, **vars(history)}))

    def read(self, net: nn.Module, optimiser: Optimizer) -> History | None:
        """Fill the net and the optimiser from the file and return the history.

        Returns None and changes neither when the file is damaged or of another recipe.
        """
        try:
            note, state = read_tensors(self.path)
        except (OSError, Misread):
            return None
        if not isinstance(note, dict) or note.get("recipe") != self.recipe:
            return None
        weights: dict[str, Tensor] = {}
        moments: dict[int, dict[str, Tensor]] = {}
        for key, value in state.items():
            part, _, name = key.partition(".")
            if part == "model":
                weights[name] = value
            else:
                number, _, name = name.partition(".")
                moments.setdefault(int(number), {})[name] = value
        net.load_state_dict(weights)
        optimiser.load_state_dict(optimiser.state_dict() | {"state": moments})
        return History(tuple(note["training_loss"]), tuple(note["validation"]), note["duration_s"])


def run(
    task: FitTask,
    net: nn.Module,
    journal: Journal | None = None,
    progress: Callable[[FitProgress], None] | None = None,
    notice: Callable[[str], None] | None = None,
) -> History:
    """Fit all epochs, or those after the journal's last one.

    `progress` is called after each minibatch, `notice` with a sentence if the journal is not used.
    Raises `Diverged` for a loss, weights or metrics that are not finite.
    """
    import torch

    def diverged(what: str) -> Diverged:
        kept = f"; the state after epoch {epoch} is kept in {journal.path}" if journal else ""
        return Diverged(
            f"the {what} of {task.name}-{task.seed} left the finite numbers in epoch {epoch + 1} "
            f"of {task.schedule.epochs}: lower the learning rate or clip the gradient"
            f"{kept if epoch else ''}."
        )

    history, optimiser = History(), _optimiser(task.schedule, net)
    if journal is not None and journal.path.exists():
        restored = journal.read(net, optimiser)
        if restored is None and notice is not None:
            notice(f"{journal.path} is damaged or of another fit: starting from the first epoch.")
        history = restored or history
    while (epoch := len(history.training_loss)) < task.schedule.epochs:
        started = time.monotonic()
        loss = _train(task, net, optimiser, epoch, progress)
        if not math.isfinite(loss):
            raise diverged("loss")
        net.eval()
        with torch.no_grad():
            metrics = {key: float(value) for key, value in task.validate(net).items()}
        finite = all(map(math.isfinite, metrics.values()))
        if not finite or not all(v.isfinite().all() for v in net.parameters()):
            raise diverged("weights or validation")
        history = History(
            (*history.training_loss, loss),
            (*history.validation, metrics),
            history.duration_s + time.monotonic() - started,
        )
        if journal is not None:
            journal.write(net, optimiser, history)
    return history


def _optimiser(schedule: Schedule, net: nn.Module) -> Optimizer:
    from torch import optim

    fitted = [parameter for parameter in net.parameters() if parameter.requires_grad]
    if schedule.optimiser == "adam":
        return optim.Adam(fitted, lr=schedule.learning_rate)
    return optim.AdamW(fitted, lr=schedule.learning_rate, weight_decay=schedule.weight_decay)


def _train(
    task: FitTask,
    net: nn.Module,
    optimiser: Optimizer,
    epoch: int,
    progress: Callable[[FitProgress], None] | None,
) -> float:
    """Fit one epoch and return its mean loss; stop at a loss that is not finite and return that."""
    from torch import nn

    schedule, total = task.schedule, 0.0
    task.begin_epoch(epoch)
    net.train()
    batches = minibatches(task, epoch)
    for number, index in enumerate(batches):
        optimiser.zero_grad(set_to_none=True)
        loss = task.loss(net, index)
        value = loss.item()
        if not math.isfinite(value):
            return value
        loss.backward()
        if schedule.clip_norm is not None:
            nn.utils.clip_grad_norm_(net.parameters(), schedule.clip_norm)
        optimiser.step()
        total += value * len(index)
        if progress is not None:
            done = epoch + (number + 1) / len(batches)
            progress(FitProgress(epoch, done / schedule.epochs, value))
    return total / task.count


def minibatches(task: FitTask, epoch: int) -> tuple[LongTensor, ...]:
    """Return a permutation of the samples in minibatches, addressed by order, seed and epoch."""
    import torch

    draws = generator(task.order_key, "minibatches", task.seed, epoch)
    order: Any = torch.from_numpy(draws.permutation(task.count))
    return order.split(task.schedule.batch_size)
