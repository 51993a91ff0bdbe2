"""Fit one model of the quadrotor: from wherever an earlier call left it, into weights and a card.

Laws. The initial weights and the order of the minibatches depend on the task's `order_key` and its
seed only. A finished model is fitted again only when what decides its weights has changed.
"""

import json
import logging
import math
from abc import abstractmethod
from collections.abc import Callable, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

import torch
from torch import nn

from faultpath import __version__
from faultpath.plugin.data import make_folder
from faultpath.plugin.system import UserError, contents
from faultpath.plugin.training import (
    FitProgress,
    FitTask,
    Journal,
    minibatches,
    parameter_count,
    read_card,
    run,
    save,
    weights_sha256,
)
from faultpath_quadrotor.models import ModelCard

_SAME_LOSS = 1e-3
"""Relative difference of a first loss that machines may cause and a change of code does not."""
_log = logging.getLogger("faultpath")


class ModelTask(FitTask):
    """One model to be fitted, with a seed; its data, its loss, and what its card says."""

    platform: str = ""
    """`PLATFORM.weights_hash` of the model; empty for a task that no platform decides."""

    @abstractmethod
    def load(self) -> None:
        """Read the data; `UserError` when they are missing or damaged."""

    @abstractmethod
    def module(self) -> nn.Module:
        """Return a freshly initialised model in float32.

        Its weights depend on the seed and the base architecture only, never on the corruption, so
        that a baseline and its +DCC variant start from the same ones.
        """

    @abstractmethod
    def describe(self) -> Mapping[str, Any]:
        """Return the settings that decide the result, as JSON values, for the model card.

        A finished model is fitted again when it changes. Two keys have a place of their own in
        the card: `description`, a sentence, and `data_sha256`, a digest for each pool.
        """


def fit(
    task: ModelTask,
    folder: Path,
    progress: Callable[[FitProgress], None] | None = None,
    notice: Callable[[str], None] = _log.warning,
) -> Path:
    """Fit a model, from wherever an earlier call left it, and return its weights file.

    `folder` gets `<name>-<seed>.safetensors` and its card; a journal beside them while the fit is
    unfinished. `progress` is called after each minibatch; `notice` with a sentence when something
    in the folder is not used and the model is fitted again.

    Raises `Diverged` for a loss or weights that are not finite, and `UserError` for missing data
    or a folder that cannot be written.
    """
    make_folder(folder)
    task.load()
    path = folder / f"{task.name}-{task.seed}.safetensors"
    if task.count < 1:
        raise UserError(f"{path.stem} has no training samples: collect its data again.")
    net = task.module()
    initial = weights_sha256(net)
    # Before any step the loss depends on data, features, corruption, order and loss, so that a
    # change of their code shows without a digest of the code.
    task.begin_epoch(0)
    net.train()
    with torch.no_grad():
        first_loss = float(task.loss(net, minibatches(task, 0)[0]))
    described = dict(task.describe())
    description = str(described.pop("description", ""))
    recipe = {
        "name": task.name,
        "seed": task.seed,
        "platform": task.platform,
        "samples": task.count,
        "schedule": task.schedule.model_dump(mode="json"),
        "order_key": task.order_key,
        "data_sha256": described.pop("data_sha256", {}),
        "config": json.loads(json.dumps(described)),
        "initial_sha256": initial,
        "first_loss": first_loss,
    }
    if _is_finished(path, recipe, notice):
        return path
    journal = Journal(journal_path(path), recipe)
    history = run(task, net, journal, progress, notice)
    card = ModelCard(
        **recipe,
        **vars(history),
        description=description,
        parameters=parameter_count(net),
        weights_sha256=weights_sha256(net),
        torch_version=torch.__version__,
        faultpath_version=__version__,
    )
    save(net, card, folder)
    journal.path.unlink(missing_ok=True)
    return path


def journal_path(weights: Path) -> Path:
    """Return the journal's place for the weights file of a model."""
    return weights.with_name(f"{weights.stem}.unfinished.safetensors")


def _is_finished(path: Path, recipe: Mapping[str, Any], notice: Callable[[str], None]) -> bool:
    """Return whether the checkpoint exists and is of this very task."""
    if not path.exists():
        return False
    try:
        card = read_card(path, ModelCard)
    except UserError as error:
        notice(f"{path.stem} is fitted again: {error}")
        return False
    stored = card.model_dump(mode="json", include=set(recipe))
    changed = [key for key, value in recipe.items() if stored[key] != value]
    if math.isclose(card.first_loss, recipe["first_loss"], rel_tol=_SAME_LOSS):
        changed = [key for key in changed if key != "first_loss"]
    if changed:
        notice(f"{path.stem} is fitted again: {', '.join(changed)} changed.")
        return False
    if sha256(contents(path)).hexdigest() != card.weights_sha256:
        notice(f"{path.stem} is fitted again: its weights are not those of its card.")
        return False
    return True
