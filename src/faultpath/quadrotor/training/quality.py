"""How good every trained model is on windows that it was not fitted to."""

from collections.abc import Callable, Sequence
from pathlib import Path

import torch
from pydantic import JsonValue

from faultpath.errors import UserError
from faultpath.quadrotor.card import ModelCard, read_card, stem
from faultpath.quadrotor.models import (
    PREDICTORS,
    RECONSTRUCTIONS,
    Kind,
    Model,
    Shelf,
    clearance_model,
)
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.platform import Platform
from faultpath.quadrotor.platforms import DEFAULT
from faultpath.quadrotor.training import quality_rows
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
from faultpath.quadrotor.training.quality_rows import (
    levels,
    measure_predictor,
    measure_reconstruction,
)
from faultpath.quadrotor.training.windows import HISTORY, HORIZON, Windows, cut
from faultpath.quadrotor.vehicle import CONTROL_DT_S

POOLS = ("nominal", "wind")
_LEARNED = frozenset(entry.name for entry in ALL)

Progress = Callable[[str], None]
"""Called with the name of what is measured next."""


class Checkpoints:
    """The finished checkpoints of a folder, and which of the catalogue are not there."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf
        jobs = choose(())
        there = {job.stem for job in jobs if self._path(job.stem).with_suffix(".json").is_file()}
        self.missing = tuple(job.stem for job in jobs if job.stem not in there)
        self.present = tuple((job.entry.name, job.seed) for job in jobs if job.stem in there)

    def load(self, name: str, kind: Kind[Model]) -> dict[int | None, Model]:
        """Return a model by seed, as far as it is there; `None` alone where nothing is learned.

        `UserError` for weights that cannot be read.
        """
        seeds = [seed for found, seed in self.present if found == name]
        every = seeds if name in _LEARNED else [None]
        return {seed: kind.load(name, seed, self._shelf) for seed in every}

    def cards(self) -> list[ModelCard]:
        """Return the cards of all that is there; `UserError` for a damaged one."""
        return [read_card(self._path(stem(name, seed))) for name, seed in self.present]

    def clearance(self) -> dict[str, JsonValue] | None:
        """Return how good the clearance model is, `None` without one."""
        if (CLEARANCE.name, 0) not in self.present:
            return None
        from faultpath.quadrotor.training.clearance_task import evaluate

        return evaluate(clearance_model(shelf=self._shelf))

    def _path(self, name: str) -> Path:
        return self._shelf.place / f"{name}.safetensors"


def measure(
    data: Path,
    folder: Path | None = None,
    progress: Progress | None = None,
    platform: Platform = DEFAULT,
) -> Quality:
    """Measure every checkpoint of a folder, by default of the package, on validation windows.

    Args:
        data: Folder of the pools `nominal` and `wind`.
        folder: Folder of the checkpoints.
        progress: Is told what comes next.
        platform: That of the checkpoints and the pools.

    Raises:
        UserError: A pool is missing, a checkpoint is damaged, or was fitted to other data than
            the pool of the same name: its validation windows are then not these.
    """
    tell = progress or (lambda text: None)
    checkpoints = Checkpoints(Shelf(platform, folder))
    pools = {name: read_pool(data / f"{name}.parquet") for name in POOLS}
    _check_data(checkpoints.cards(), pools)
    held_out = {name: cut(pool).split()[1] for name, pool in pools.items()}
    episodes = {name: Episodes(name, windows.episode.numpy()) for name, windows in held_out.items()}
    with torch.inference_mode():
        predictors: list[PredictorQuality] = []
        for row in quality_rows.PREDICTORS:
            if loaded := checkpoints.load(row.name, PREDICTORS[row.name]):
                tell(f"{row.name}, {row.pool}, {row.wind} wind")
                measured = measure_predictor(row, loaded, held_out[row.pool], episodes[row.pool])
                predictors.append(measured)
        reconstructions: list[ReconstructionQuality] = []
        for row in quality_rows.RECONSTRUCTIONS:
            if loaded := checkpoints.load(row.name, RECONSTRUCTIONS[row.name]):
                tell(row.name)
                pool = row.pool
                reconstructions.append(
                    measure_reconstruction(
                        row, loaded, held_out[pool], episodes[pool], platform.winds
                    )
                )
        tell(CLEARANCE.name)
        clearance = checkpoints.clearance()
    return Quality(
        settings=_settings(platform.winds),
        pools={
            name: _pool(pools[name], windows, episodes[name].count, platform.winds)
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


def _pool(pool: Pool, windows: Windows, episodes: int, winds: Winds) -> PoolUsed:
    level = levels(windows, winds)
    return PoolUsed(
        rows_sha256=pool.provenance.rows_sha256,
        windows=len(windows),
        episodes=episodes,
        by_level={name: int((level == name).sum()) for name in winds.levels},
    )


def _settings(winds: Winds) -> Settings:
    return Settings(
        history=HISTORY,
        horizon=HORIZON,
        step_s=CONTROL_DT_S,
        resamples=RESAMPLES,
        calibration_errors=quality_rows.ERRORS,
        level_mean_mps={name: level.mean_mps for name, level in winds.levels.items()},
    )
