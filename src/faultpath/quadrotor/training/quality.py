"""How good every trained model is on windows that it was not fitted to."""

from collections.abc import Callable, Sequence
from pathlib import Path

import torch
from pydantic import JsonValue

from faultpath.errors import UserError
from faultpath.quadrotor import models
from faultpath.quadrotor.card import ModelCard, read_card, stem
from faultpath.quadrotor.checkpoint import (
    checkpoint_path,
    load_checkpoint,
    shipped_folder,
)
from faultpath.quadrotor.predictors import AnchoredPredictor, Predictor, UnanchoredPredictor
from faultpath.quadrotor.reconstruction import (
    Reconstruction,
    RecurrentReconstruction,
    WindNetwork,
)
from faultpath.quadrotor.training import quality_predictors, quality_reconstructions
from faultpath.quadrotor.training.catalogue import ALL, CLEARANCE, choose
from faultpath.quadrotor.training.pool import Pool, read_pool
from faultpath.quadrotor.training.quality_intervals import RESAMPLES, Episodes
from faultpath.quadrotor.training.quality_results import (
    CheckpointUsed,
    PoolUsed,
    PredictorQuality,
    Quality,
    ReconstructionQuality,
    Settings,
)
from faultpath.quadrotor.training.reconstruction_task import MODELS
from faultpath.quadrotor.training.windows import HISTORY, HORIZON, Windows, cut
from faultpath.quadrotor.vehicle import CONTROL_DT_S
from faultpath.quadrotor.wind import WIND_LEVELS

POOLS = ("nominal", "wind")
_LEARNED = frozenset(entry.name for entry in ALL)

Progress = Callable[[str], None]
"""Called with the name of what is measured next."""


class Checkpoints:
    """The finished checkpoints of a folder, and which of the catalogue are not there."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        jobs = choose(())
        there = {job.stem for job in jobs if self._path(job.stem).with_suffix(".json").is_file()}
        self.missing = tuple(job.stem for job in jobs if job.stem not in there)
        self.present = tuple((job.entry.name, job.seed) for job in jobs if job.stem in there)

    def seeds(self, name: str) -> Sequence[int | None]:
        """Return the seeds of a model that are there; `None` alone for one that learns nothing."""
        if name not in _LEARNED:
            return (None,)
        return [seed for found, seed in self.present if found == name]

    def cards(self) -> list[ModelCard]:
        """Return the cards of all that is there; `UserError` for a damaged one."""
        return [read_card(self._path(stem(name, seed))) for name, seed in self.present]

    def predictor(self, name: str, seed: int | None) -> Predictor:
        """Return a predictor with its weights; `UserError` when they cannot be read."""
        made = models.PREDICTORS[name].load(name, None)
        if seed is not None:
            assert isinstance(made, AnchoredPredictor | UnanchoredPredictor)
            load_checkpoint(made.network, checkpoint_path(name, seed, self._folder))
        return made

    def reconstruction(self, name: str, seed: int | None) -> Reconstruction:
        """Return a reconstruction with its weights; `UserError` when they cannot be read."""
        if seed is None:
            return models.RECONSTRUCTIONS[name].load(name, None)
        network = WindNetwork(MODELS[name].calibrated)
        load_checkpoint(network, checkpoint_path(name, seed, self._folder))
        return RecurrentReconstruction(network)

    def clearance(self) -> dict[str, JsonValue] | None:
        """Return how good the clearance model is, `None` without one."""
        if not self.seeds(CLEARANCE.name):
            return None
        from faultpath.quadrotor.perception import ClearanceModel
        from faultpath.quadrotor.training.clearance_task import evaluate

        model = ClearanceModel()
        load_checkpoint(model, checkpoint_path(CLEARANCE.name, 0, self._folder))
        return evaluate(model.eval())

    def _path(self, name: str) -> Path:
        return self._folder / f"{name}.safetensors"


def measure(data: Path, folder: Path | None = None, progress: Progress | None = None) -> Quality:
    """Measure every checkpoint of a folder, by default of the package, on validation windows.

    Args:
        data: Folder of the pools `nominal` and `wind`.
        folder: Folder of the checkpoints.
        progress: Is told what comes next.

    Raises:
        UserError: A pool is missing, a checkpoint is damaged, or was fitted to other data than
            the pool of the same name: its validation windows are then not these.
    """
    tell = progress or (lambda text: None)
    checkpoints = Checkpoints(folder or shipped_folder())
    pools = {name: read_pool(data / f"{name}.parquet") for name in POOLS}
    _check_data(checkpoints.cards(), pools)
    held_out = {name: cut(pool).split()[1] for name, pool in pools.items()}
    episodes = {name: Episodes(name, windows.episode.numpy()) for name, windows in held_out.items()}
    with torch.inference_mode():
        predictors = _predictors(checkpoints, held_out, episodes, tell)
        reconstructions = _reconstructions(checkpoints, held_out, episodes, tell)
        tell(CLEARANCE.name)
        clearance = checkpoints.clearance()
    return Quality(
        settings=_settings(),
        pools={
            name: _pool(pools[name], windows, episodes[name].count)
            for name, windows in held_out.items()
        },
        checkpoints=tuple(
            CheckpointUsed(**card.model_dump(include=set(CheckpointUsed.model_fields)))
            for card in checkpoints.cards()
        ),
        missing=checkpoints.missing,
        predictors=tuple(predictors),
        reconstructions=tuple(reconstructions),
        clearance=clearance,
    )


def _predictors(
    checkpoints: Checkpoints,
    windows: dict[str, Windows],
    episodes: dict[str, Episodes],
    tell: Progress,
) -> list[PredictorQuality]:
    found = []
    for row in quality_predictors.ROWS:
        if seeds := checkpoints.seeds(row.name):
            tell(f"{row.name}, {row.pool}, {row.wind} wind")
            loaded = {seed: checkpoints.predictor(row.name, seed) for seed in seeds}
            found.append(
                quality_predictors.measure(row, loaded, windows[row.pool], episodes[row.pool])
            )
    return found


def _reconstructions(
    checkpoints: Checkpoints,
    windows: dict[str, Windows],
    episodes: dict[str, Episodes],
    tell: Progress,
) -> list[ReconstructionQuality]:
    pool = quality_reconstructions.POOL
    found = []
    for name in quality_reconstructions.NAMES:
        if seeds := checkpoints.seeds(name):
            tell(name)
            loaded = {seed: checkpoints.reconstruction(name, seed) for seed in seeds}
            found.append(
                quality_reconstructions.measure(name, loaded, windows[pool], episodes[pool])
            )
    return found


def _check_data(cards: Sequence[ModelCard], pools: dict[str, Pool]) -> None:
    for card in cards:
        for name, pool in pools.items():
            if card.data_sha256.get(name, pool.provenance.rows_sha256) != (
                pool.provenance.rows_sha256
            ):
                raise UserError(
                    f"the checkpoint {card.stem} was fitted to another pool '{name}' than the one "
                    "in the data folder: collect the pool again or fit the model again."
                )


def _pool(pool: Pool, windows: Windows, episodes: int) -> PoolUsed:
    level = quality_reconstructions.levels(windows)
    return PoolUsed(
        rows_sha256=pool.provenance.rows_sha256,
        windows=len(windows),
        episodes=episodes,
        by_level={name: int((level == name).sum()) for name in WIND_LEVELS},
    )


def _settings() -> Settings:
    return Settings(
        history=HISTORY,
        horizon=HORIZON,
        step_s=CONTROL_DT_S,
        resamples=RESAMPLES,
        calibration_errors=quality_predictors.ERRORS,
        level_mean_mps={name: level.mean_mps for name, level in WIND_LEVELS.items()},
    )
