"""Where an unfinished fit stands: one file, written whole after every epoch.

It holds everything that the next epoch depends on, so that a fit which was killed at any moment
gives the same weights, bit for bit, as one that was not.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor, nn
from torch.optim import Optimizer

from faultpath.files.opening import opened
from faultpath.quadrotor.checkpoint import tensors
from faultpath.store.atomic import write

FORMAT = "faultpath-fit/1"
_ENTRY = "fit"  # one entry only: the order of several in the file is not fixed


@dataclass(frozen=True)
class History:
    """What earlier epochs gave; one entry an epoch."""

    training_loss: tuple[float, ...] = ()
    validation: tuple[dict[str, float], ...] = ()
    duration_s: float = 0.0

    @property
    def epochs(self) -> int:
        """Number of finished epochs."""
        return len(self.training_loss)

    def after(self, loss: float, metrics: dict[str, float], duration_s: float) -> "History":
        """Return the history with one more epoch."""
        return History(
            (*self.training_loss, loss),
            (*self.validation, metrics),
            self.duration_s + duration_s,
        )


def journal_path(weights: Path) -> Path:
    """Return the journal's place for the weights file of a model."""
    return weights.with_name(f"{weights.stem}.unfinished.safetensors")


def write_journal(
    path: Path,
    module: nn.Module,
    optimiser: Optimizer,
    recipe: dict[str, Any],
    history: History,
) -> None:
    """Write weights, moments and step counts of the optimiser, and the history."""
    state = {f"model.{name}": value for name, value in tensors(module).items()}
    for number, moments in optimiser.state_dict()["state"].items():
        state |= {f"optimiser.{number}.{key}": value for key, value in moments.items()}
    header = {"format": FORMAT, "recipe": recipe} | vars(history)
    write(path, save(state, {_ENTRY: json.dumps(header)}))


def read_journal(
    path: Path, module: nn.Module, optimiser: Optimizer, recipe: dict[str, Any]
) -> History | None:
    """Fill the model and the optimiser from a journal and return the history.

    Returns None, and leaves both alone, when the file is damaged or of another recipe.
    """
    try:
        opened(path).close()
        with safe_open(path, framework="pt") as file:
            header = json.loads((file.metadata() or {}).get(_ENTRY, "{}"))
            state = {key: file.get_tensor(key).clone() for key in file.keys()}  # noqa: SIM118 - a file is no mapping: it has keys, and no iterator
    except (SafetensorError, OSError, json.JSONDecodeError):
        return None
    if header.get("format") != FORMAT or header.get("recipe") != recipe:
        return None
    module.load_state_dict(_under("model.", state))
    moments: dict[int, dict[str, Tensor]] = {}
    for key, value in _under("optimiser.", state).items():
        number, _, name = key.partition(".")
        moments.setdefault(int(number), {})[name] = value
    optimiser.load_state_dict(optimiser.state_dict() | {"state": moments})
    return History(
        tuple(header["training_loss"]), tuple(header["validation"]), header["duration_s"]
    )


def _under(prefix: str, state: dict[str, Tensor]) -> dict[str, Tensor]:
    return {k.removeprefix(prefix): v for k, v in state.items() if k.startswith(prefix)}
