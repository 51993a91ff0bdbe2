"""Everything of the quadrotor that can be fitted, by name.

The tasks load when they are built: the names alone must not cost their imports, torch included.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from faultpath.plugin.system import UserError
from faultpath_quadrotor.training import CLEARANCE_POOL, TRAJECTORY_POOL

if TYPE_CHECKING:
    from faultpath_quadrotor.training.fitting import ModelTask

Factory = Callable[[str, int, Path], "ModelTask"]
"""Makes a task from its name, its seed and the folder of the data; a function of a module, so that
worker processes find it."""

MODEL_SEEDS = (0, 1, 2)
"""Seeds of the models that results average over (paper, captions of its tables)."""
SHARED_LOSS_SEEDS = (*MODEL_SEEDS, 3, 4, 5)
"""Seeds of the models that decide how large the loss under a shared fault is."""


@dataclass(frozen=True)
class ModelEntry:
    """A model that can be fitted."""

    name: str
    factory: Factory
    pools: tuple[str, ...]
    """Pools of data that it needs and `collect_missing` makes, `<data folder>/<pool>.*`."""
    description: str
    cost: float
    """Expected time of a fit relative to the other models: the order of work depends on it, and
    the time left until a fit has shown its pace."""
    seeds: tuple[int, ...] = MODEL_SEEDS
    after: tuple[str, ...] = ()
    """Models whose seed 0 flies for its data, with the checkpoint in the package."""


@dataclass(frozen=True)
class FitJob:
    """One model with one seed."""

    entry: ModelEntry
    seed: int

    @property
    def stem(self) -> str:
        """Name of its files without their ending."""
        return f"{self.entry.name}-{self.seed}"

    def task(self, data: Path) -> ModelTask:
        """Return the task of fitting it, with data from a folder."""
        return self.entry.factory(self.entry.name, self.seed, data)


def _task(name: str, seed: int, data: Path) -> ModelTask:
    """Return the task of a model below."""
    from faultpath_quadrotor.training.clearance_task import ClearanceTask
    from faultpath_quadrotor.training.predictor_task import PredictorTask
    from faultpath_quadrotor.training.reconstruction_task import ReconstructionTask

    if name == CLEARANCE.name:
        return ClearanceTask(seed, data)
    predicts = any(entry.name == name for entry in PREDICTORS)
    return (PredictorTask if predicts else ReconstructionTask)(name, seed, data)


_NOMINAL, _WIND, _BOTH, _FLOWN = ("nominal",), ("wind",), ("nominal", "wind"), (TRAJECTORY_POOL,)
_SIX = SHARED_LOSS_SEEDS
PREDICTORS = (
    ModelEntry("wm-a", _task, _NOMINAL, "physics-anchored predictor", 4),
    ModelEntry("wm-a+dcc", _task, _NOMINAL, "wm-a fitted with perturbed calibration", 4),
    ModelEntry("wm-u", _task, _NOMINAL, "unanchored predictor", 12),
    ModelEntry("wm-u+dcc", _task, _NOMINAL, "wm-u fitted with perturbed calibration", 12),
    ModelEntry("wm-a-wind", _task, _BOTH, "wm-a with the wind as an input", 8, _SIX),
    ModelEntry("wm-a-nowind", _task, _BOTH, "wm-a on the same windy data without that input", 8),
)
_TRAJECTORY = "gru on closed-loop flights of selection scenes"
RECONSTRUCTIONS = (
    ModelEntry("gru", _task, _WIND, "wind from the history, given calibration", 5, _SIX),
    ModelEntry("gru+dcc", _task, _WIND, "gru fitted with perturbed calibration", 5, _SIX),
    ModelEntry("gru+state", _task, _WIND, "gru fitted with perturbed motion", 5, (0,)),
    ModelEntry("gru-withheld", _task, _WIND, "gru without calibration", 5),
    ModelEntry("gru-trajectory", _task, _FLOWN, _TRAJECTORY, 2, after=("wm-a-wind",)),
)
_DEPTH = (CLEARANCE_POOL,)
CLEARANCE = ModelEntry("clearance", _task, _DEPTH, "obstacle clearance from depth", 6, (0,))

ALL = (*PREDICTORS, *RECONSTRUCTIONS, CLEARANCE)
GROUPS: dict[str, tuple[ModelEntry, ...]] = {
    "predictors": PREDICTORS,
    "reconstructions": RECONSTRUCTIONS,
    "all": ALL,
}


def choose(names: Sequence[str], seeds: Sequence[int] = ()) -> tuple[FitJob, ...]:
    """Return the jobs of some models or groups, each once, in the order of the catalogue.

    Without names: everything. Without seeds: the default seeds of each model. Raises `UserError`
    for a name that is not known.
    """
    chosen: set[str] = set()
    for name in names or ("all",):
        matches = GROUPS.get(name) or [entry for entry in ALL if entry.name == name]
        if not matches:
            known = ", ".join(entry.name for entry in ALL)
            raise UserError(
                f"the quadrotor has no model '{name}' to train; it has {known}, and the groups "
                f"{', '.join(GROUPS)}."
            )
        chosen |= {entry.name for entry in matches}
    entries = [entry for entry in ALL if entry.name in chosen]
    return tuple(FitJob(entry, s) for entry in entries for s in dict.fromkeys(seeds or entry.seeds))


def stages(jobs: Sequence[FitJob]) -> tuple[tuple[FitJob, ...], ...]:
    """Part the jobs into those that come first and those whose data are flown with them."""
    parted = (tuple(j for j in jobs if bool(j.entry.after) == late) for late in (False, True))
    return tuple(filter(None, parted))
