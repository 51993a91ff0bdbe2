"""Collects the pools of training episodes."""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from faultpath.errors import UserError
from faultpath.execution.provenance import packages
from faultpath.quadrotor.plant import wind
from faultpath.quadrotor.plant.wind import Winds
from faultpath.quadrotor.platform import PLATFORM
from faultpath.quadrotor.training.batches import Batch, Progress, make_pools
from faultpath.quadrotor.training.flight import EPISODE_STEPS, fly
from faultpath.quadrotor.training.provenance import (
    Recipe,
    code_sha256,
    read_provenance,
)
from faultpath.store import atomic
from faultpath.store.lock import locked

EPISODES = {"nominal": 7_150, "wind": 14_891}  # paper, Section IV-A
BATCH = 1024
"""Episodes flown together. The plant's cost a vehicle still falls beyond this; a larger batch would
need more memory for its winds, and a kill would lose more."""

_log = logging.getLogger("faultpath")


def collect(
    folder: Path,
    pools: Sequence[str] = ("nominal", "wind"),
    workers: int = 2,
    episodes: Mapping[str, int] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> dict[str, Path]:
    """Collect `pools` into `folder` and return the file of each pool.

    A pool that is there already is kept, one that was begun is finished. `episodes` gives the
    number of episodes of a pool where it is not the paper's; `workers` is the number of processes,
    0 for this one. Raises `UserError` for a pool that
    does not exist, for one that was collected by another recipe, and when `folder` cannot be
    written.
    """
    recipes = {name: recipe(name, (episodes or {}).get(name), seed) for name in pools}
    paths = {name: folder / f"{name}.parquet" for name in pools}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder, _log.warning):
            atomic.sweep(folder)
            missing = [name for name in pools if not _is_there(paths[name], recipes[name])]
            batches = {
                paths[name]: (recipes[name], _batches(recipes[name], folder)) for name in missing
            }
            make_pools(batches, workers, progress, EPISODE_STEPS)
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to "
            "and that has room."
        ) from error
    return paths


def recipe(pool: str, episodes: int | None = None, seed: int = 0) -> Recipe:
    """Return what decides a pool's numbers; `UserError` for a pool that cannot be."""
    if pool not in EPISODES:
        raise UserError(f"there is no pool '{pool}': choose from {', '.join(EPISODES)}.")
    count = EPISODES[pool] if episodes is None else episodes
    if count < 1:
        raise UserError(f"pool '{pool}' cannot have {count} episodes: ask for at least one.")
    return Recipe(
        pool=pool,
        episodes=count,
        seed=seed,
        flight=PLATFORM.collection,
        vehicle=PLATFORM.ranges,
        wind=_wind_ranges(PLATFORM.winds) if pool == "wind" else {},
        code_sha256=code_sha256(),
    )


def _wind_ranges(winds: Winds) -> dict[str, float | tuple[float, float]]:
    return {
        "mean_mps": winds.pool_mean_mps,
        "turbulence_over_mean": wind.TURBULENCE_OVER_MEAN,
        "length_scale_m": wind.LENGTH_SCALE_M,
        "cruise_mps": wind.CRUISE_MPS,
        "gust_duration_s": wind.GUST_DURATION_S,
        "gust_over_mean": wind.GUST_OVER_MEAN,
        "gust_onset_s": wind.GUST_ONSET_S,
    }


def _is_there(path: Path, asked: Recipe) -> bool:
    found = read_provenance(path)
    if found is None:
        return False
    for field in different(found, asked):
        how = "by other code" if field == "code_sha256" else f"with another '{field}'"
        raise UserError(
            f"the pool at {path} was collected {how}: choose another folder, "
            f"or delete its {path.stem}.json to collect it again."
        )
    return True


def different(found: Recipe, asked: Recipe) -> list[str]:
    """Return the fields in which two recipes differ."""
    return [name for name in Recipe.model_fields if getattr(found, name) != getattr(asked, name)]


def _batches(asked: Recipe, folder: Path) -> list[Batch]:
    """Return a pool's batches, in a folder whose name changes with anything that decides them.

    The number of episodes does not: a pool that is asked for larger uses what is there.
    """
    content = json.dumps([asked.model_dump(mode="json", exclude={"episodes"}), packages()])
    place = folder / f".{asked.pool}-{hashlib.sha256(content.encode()).hexdigest()[:16]}"
    members = [
        range(first, min(first + BATCH, asked.episodes))
        for first in range(0, asked.episodes, BATCH)
    ]
    return [
        Batch(
            place / f"{each.start:06d}+{len(each)}",
            each,
            partial(fly, asked.pool, each, asked.seed),
        )
        for each in members
    ]
