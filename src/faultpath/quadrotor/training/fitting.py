"""Fit one model: epochs of minibatches, resumable to the bit.

Laws. The initial weights and the order of the minibatches depend on the task's `order_key` and its
seed only. A fit that was killed and run again ends with the same weights as one that was not. A
finished model is fitted again only when what decides its weights has changed.
"""

import json
import logging
import math
import time
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import torch
from safetensors.torch import save
from torch import LongTensor, nn
from torch.optim import Adam, AdamW, Optimizer

from faultpath.errors import UserError
from faultpath.files.opening import contents
from faultpath.quadrotor.card import read_card, stem
from faultpath.quadrotor.checkpoint import digest, save_checkpoint, tensors
from faultpath.quadrotor.training.journal import (
    History,
    journal_path,
    read_journal,
    write_journal,
)
from faultpath.quadrotor.training.task import Schedule, Task
from faultpath.store import make_folder
from faultpath.streams import generator
from faultpath.text import extra
from faultpath.version import __version__

_SAME_LOSS = 1e-3
"""Relative difference of a first loss that machines may cause and a change of code does not."""
_log = logging.getLogger("faultpath")

Plot = Callable[[int, Mapping[str, float]], None]
"""Adds numbers of an epoch, counted from 1, to the curves."""


class Diverged(UserError):
    """A fit left the finite numbers; the state after its last good epoch is kept."""


@dataclass(frozen=True)
class Moment:
    """How far a fit is."""

    epoch: int
    """Epoch at work, counted from 0."""
    fraction: float
    """Part of all minibatches that is done."""
    loss: float
    """Loss of the last minibatch."""


def fit(
    task: Task,
    folder: Path,
    progress: Callable[[Moment], None] | None = None,
    tensorboard: Path | None = None,
    notice: Callable[[str], None] = _log.warning,
) -> Path:
    """Fit a model, from wherever an earlier call left it, and return its weights file.

    `folder` gets `<name>-<seed>.safetensors` and its card; a journal beside them while the fit is
    unfinished. `progress` is called after each minibatch; `notice` with a sentence when something
    in the folder is not used and the model is fitted again. `tensorboard` gets the curves.

    Raises `Diverged` for a loss or weights that are not finite, and `UserError` for missing data
    or a folder that cannot be written.
    """
    make_folder(folder)
    task.load()
    path = folder / f"{stem(task.name, task.seed)}.safetensors"
    work = _Work(task, path)
    if not work.finished(notice):
        work.resume(notice)
        with _curves(tensorboard, path.stem) as plot:
            work.run(progress or (lambda moment: None), plot)
        work.finish()
    return path


def forget(name: str, seed: int, folder: Path) -> None:
    """Remove a model and its journal from a folder, so that it is fitted from the start."""
    path = folder / f"{stem(name, seed)}.safetensors"
    for each in (path.with_suffix(".json"), path, journal_path(path)):
        each.unlink(missing_ok=True)


class _Work:
    """One model between its initial weights and its checkpoint."""

    def __init__(self, task: Task, path: Path) -> None:
        self._task = task
        self._path = path
        self._journal = journal_path(path)
        if task.count < 1:
            raise UserError(f"{path.stem} has no training samples: collect its data again.")
        self._module = task.module()
        self._optimiser = _optimiser(self._module, task.schedule)
        self._history = History()
        self._first_loss = self._measure_first_loss()
        self._recipe = _recipe(task, self._module)

    def finished(self, notice: Callable[[str], None]) -> bool:
        """Say whether the checkpoint is there and of this very task."""
        if not self._path.exists():
            return False
        try:
            card = read_card(self._path)
        except UserError as error:
            notice(f"{self._path.stem} is fitted again: {error}")
            return False
        found = card.model_dump(mode="json", include=set(self._recipe))
        changed = [key for key, value in self._recipe.items() if found[key] != value]
        if not math.isclose(card.first_loss, self._first_loss, rel_tol=_SAME_LOSS):
            changed.append("first_loss")
        if changed:
            notice(f"{self._path.stem} is fitted again: {', '.join(changed)} changed.")
            return False
        if digest(contents(self._path)) != card.weights_sha256:
            notice(f"{self._path.stem} is fitted again: its weights are not those of its card.")
            return False
        return True

    def resume(self, notice: Callable[[str], None]) -> None:
        """Go to the end of the last epoch that a journal of this task holds."""
        if not self._journal.exists():
            return
        found = read_journal(self._journal, self._module, self._optimiser, self._started())
        if found is None:
            notice(f"{self._journal} is damaged or of another fit: starting from the first epoch.")
        else:
            self._history = found

    def run(self, progress: Callable[[Moment], None], plot: Plot) -> None:
        """Fit the epochs that are left."""
        while (epoch := self._history.epochs) < self._task.schedule.epochs:
            started = time.monotonic()
            loss = self._epoch(epoch, progress)
            metrics = self._validate()
            finite = all(map(math.isfinite, (loss, *metrics.values())))
            if not finite or not all(v.isfinite().all() for v in self._module.parameters()):
                raise self._diverged(epoch, "weights or validation")
            self._history = self._history.after(loss, metrics, time.monotonic() - started)
            write_journal(
                self._journal, self._module, self._optimiser, self._started(), self._history
            )
            plot(epoch + 1, {"training/loss": loss})
            plot(epoch + 1, {f"validation/{key}": value for key, value in metrics.items()})

    def finish(self) -> None:
        """Write the checkpoint and drop the journal."""
        card = self._recipe | vars(self._history)
        card |= {
            "description": str(self._task.describe().get("description", "")),
            "first_loss": self._first_loss,
            "torch_version": torch.__version__,
            "faultpath_version": __version__,
        }
        save_checkpoint(self._module, self._path, card)
        self._journal.unlink(missing_ok=True)

    def _epoch(self, epoch: int, progress: Callable[[Moment], None]) -> float:
        """Fit one epoch and return the mean loss of its samples."""
        schedule, total = self._task.schedule, 0.0
        self._task.begin_epoch(epoch)
        self._module.train()
        batches = _minibatches(self._task, epoch)
        for number, index in enumerate(batches):
            self._optimiser.zero_grad(set_to_none=True)
            loss = self._task.loss(self._module, index)
            value = loss.item()
            if not math.isfinite(value):
                raise self._diverged(epoch, "loss")
            loss.backward()
            if schedule.clip_norm is not None:
                nn.utils.clip_grad_norm_(self._module.parameters(), schedule.clip_norm)
            self._optimiser.step()
            total += value * len(index)
            done = epoch + (number + 1) / len(batches)
            progress(Moment(epoch, done / schedule.epochs, value))
        return total / self._task.count

    def _validate(self) -> dict[str, float]:
        self._module.eval()
        with torch.no_grad():
            return {key: float(value) for key, value in self._task.validate(self._module).items()}

    def _measure_first_loss(self) -> float:
        """Return the loss of the first minibatch before any step.

        It depends on data, features, corruption, order and loss, so that a change of their code
        shows without a digest of the code.
        """
        self._task.begin_epoch(0)
        self._module.train()
        with torch.no_grad():
            return float(self._task.loss(self._module, _minibatches(self._task, 0)[0]))

    def _started(self) -> dict[str, Any]:
        return self._recipe | {"first_loss": self._first_loss}

    def _diverged(self, epoch: int, what: str) -> Diverged:
        kept = f"the state after epoch {epoch} is kept in {self._journal}" if epoch else ""
        return Diverged(
            f"the {what} of {self._path.stem} left the finite numbers in epoch {epoch + 1} of "
            f"{self._task.schedule.epochs}: lower the learning rate or clip the gradient"
            f"{'; ' + kept if kept else ''}."
        )


def _optimiser(module: nn.Module, schedule: Schedule) -> Optimizer:
    if schedule.optimiser == "adam":
        return Adam(module.parameters(), lr=schedule.learning_rate)
    return AdamW(module.parameters(), lr=schedule.learning_rate, weight_decay=schedule.weight_decay)


def _minibatches(task: Task, epoch: int) -> tuple[LongTensor, ...]:
    """Cut a permutation of the samples; its address names the order, the seed and the epoch."""
    draws = generator(task.order_key, "minibatches", task.seed, epoch)
    order = torch.from_numpy(draws.permutation(task.count))
    return cast(tuple[LongTensor, ...], order.split(task.schedule.batch_size))


def _recipe(task: Task, module: nn.Module) -> dict[str, Any]:
    config = dict(task.describe())
    config.pop("description", None)
    recipe = {
        "name": task.name,
        "seed": task.seed,
        "platform": task.platform,
        "samples": task.count,
        "schedule": asdict(task.schedule),
        "order_key": task.order_key,
        "data_sha256": config.pop("data_sha256", {}),
        "config": config,
        "initial_sha256": digest(save(tensors(module))),
    }
    return json.loads(json.dumps(recipe))


@contextmanager
def _curves(folder: Path | None, run: str) -> Generator[Plot, None, None]:
    """Open TensorBoard's files of a run below `folder`; without a folder nothing is written."""
    if folder is None:
        yield lambda epoch, values: None
        return
    with tensorboard_writer()(str(folder / run)) as writer:

        def plot(epoch: int, values: Mapping[str, float]) -> None:
            for name, value in values.items():
                writer.add_scalar(name, value, epoch)

        yield plot


def tensorboard_writer() -> Any:
    """Return the class that writes TensorBoard's files; `UserError` where it is not installed."""
    try:
        # torch re-exports the class without saying so in its annotations.
        from torch.utils.tensorboard import SummaryWriter  # pyright: ignore[reportPrivateImportUsage]
    except ModuleNotFoundError as error:
        raise UserError(
            "--tensorboard needs the tensorboard package, which is not installed: "
            f"{extra('tensorboard')}."
        ) from error
    return SummaryWriter
