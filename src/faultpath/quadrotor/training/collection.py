"""Collects the pools of training episodes, shard by shard.

A shard depends on nothing but its pool's recipe and its place, so a run that was killed loses at
most the shards in flight, and the next one goes on there and ends with the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import logging
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from faultpath.errors import UserError
from faultpath.execution.provenance import packages
from faultpath.quadrotor import wind
from faultpath.quadrotor.platform import FIRST, Platform
from faultpath.quadrotor.training import pool as pools_on_disk
from faultpath.quadrotor.training.flight import EPISODE_S, EPISODE_STEPS
from faultpath.quadrotor.training.provenance import (
    Provenance,
    Recipe,
    code_sha256,
    read_provenance,
)
from faultpath.quadrotor.training.shards import Shard
from faultpath.quadrotor.wind import Winds
from faultpath.store import atomic
from faultpath.store.lock import locked
from faultpath.version import __version__
from faultpath.work import local, run_all

EPISODES = {"nominal": 7_150, "wind": 14_891}  # paper, Section IV-A
SHARD = 1024
"""Episodes flown together. The plant's cost a vehicle still falls beyond this; a larger shard would
need more memory for its winds, and a kill would lose more."""

Progress = Callable[[float, float], None]
"""Called with the vehicle-seconds done and those in all; its first call counts what was there."""

_log = logging.getLogger("faultpath")


def collect(
    folder: Path,
    pools: Sequence[str] = ("nominal", "wind"),
    workers: int = 2,
    episodes: Mapping[str, int] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    platform: Platform = FIRST,
) -> dict[str, Path]:
    """Collect `pools` into `folder` and return the file of each pool.

    A pool that is there already is kept, one that was begun is finished. `episodes` gives the
    number of episodes of a pool where it is not the paper's; `workers` is the number of processes,
    0 for this one. Raises `UserError` for a pool that
    does not exist, for one that was collected by another recipe, and when `folder` cannot be
    written.
    """
    recipes = {name: recipe(name, (episodes or {}).get(name), seed, platform) for name in pools}
    paths = {name: folder / f"{name}.parquet" for name in pools}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder, _log.warning):
            atomic.sweep(folder)
            missing = [name for name in pools if not _is_there(paths[name], recipes[name])]
            shards = {name: _shards(recipes[name], folder, platform) for name in missing}
            _fly([shard for name in missing for shard in shards[name]], workers, progress)
            for name in missing:
                _assemble(paths[name], recipes[name], shards[name])
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to "
            "and that has room."
        ) from error
    return paths


def recipe(
    pool: str, episodes: int | None = None, seed: int = 0, platform: Platform = FIRST
) -> Recipe:
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
        flight=platform.collection,
        vehicle=platform.ranges,
        wind=_wind_ranges(platform.winds) if pool == "wind" else {},
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
    """Whether `path` holds the pool that is asked for; `UserError` when it holds another one."""
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


def _shards(asked: Recipe, folder: Path, platform: Platform) -> list[Shard]:
    """Return a pool's shards, in a folder whose name changes with anything that decides them.

    The number of episodes does not: a pool that is asked for larger uses what is there.
    """
    content = json.dumps([asked.model_dump(mode="json", exclude={"episodes"}), packages()])
    place = folder / f".{asked.pool}-{hashlib.sha256(content.encode()).hexdigest()[:16]}"
    return [
        Shard(
            str(place), asked.pool, asked.seed, first, min(SHARD, asked.episodes - first), platform
        )
        for first in range(0, asked.episodes, SHARD)
    ]


def _fly(shards: Sequence[Shard], workers: int, progress: Progress | None) -> None:
    """Fly the shards that are not there yet."""
    for place in {Path(shard.folder) for shard in shards}:
        place.mkdir(exist_ok=True)
        atomic.sweep(place)
    todo = [shard for shard in shards if not shard.rows.exists()]
    total = sum(shard.count for shard in shards)
    done = total - sum(shard.count for shard in todo)

    def report() -> None:
        if progress is not None:
            progress(done * EPISODE_S, total * EPISODE_S)

    report()
    with local(workers) as executor:
        for place, _ in run_all(executor, [shard.fly for shard in todo]):
            done += todo[place].count
            report()


def _assemble(path: Path, asked: Recipe, shards: Sequence[Shard]) -> None:
    """Join a pool's shards into its files and remove them."""
    rows = pools_on_disk.join(shard.rows.read_bytes() for shard in shards)
    episodes = pools_on_disk.join(shard.episodes.read_bytes() for shard in shards)
    steps = pools_on_disk.steps_of(episodes)
    provenance = Provenance(
        **dict(asked),
        faultpath_version=__version__,
        packages=packages(),
        rows=int(steps.sum()) + len(steps),
        vehicle_seconds=pools_on_disk.vehicle_seconds(steps),
        ended_early=int((steps < EPISODE_STEPS).sum()),
        rows_sha256=hashlib.sha256(rows).hexdigest(),
        episodes_sha256=hashlib.sha256(episodes).hexdigest(),
    )
    pools_on_disk.write_pool(path, rows, episodes, provenance)
    for place in path.parent.glob(f".{asked.pool}-*"):  # also of recipes that are no more
        shutil.rmtree(place)
