"""Collects pools of training episodes, batch by batch, joined when all batches are there.

A batch depends on nothing but its pool's recipe and its place, so a run that was killed loses at
most the batches in flight, and the next one goes on there and ends with the same bytes.
"""

import hashlib
import json
import logging
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from faultpath import __version__
from faultpath.plugin.data import locked, packages, sweep, write
from faultpath.plugin.system import UserError
from faultpath_quadrotor.training.flight import fly
from faultpath_quadrotor.training.parts import DataFile, Progress, make_missing
from faultpath_quadrotor.training.pool import episodes_path, join_flights, write_flights
from faultpath_quadrotor.training.provenance import (
    PoolProvenance,
    PoolRecipe,
    code_of,
    provenance_path,
    read_provenance,
)
from faultpath_quadrotor.training.recorded import Flights

EPISODES = {"nominal": 7_150, "wind": 14_891}  # paper, Section IV-A
BATCH = 1024
"""Episodes flown together. The plant's cost a vehicle still falls beyond this; a larger batch would
need more memory for its winds, and a kill would lose more."""

_log = logging.getLogger("faultpath")


@dataclass(frozen=True)
class EpisodeBatch:
    """Episodes that are flown together."""

    name: str
    """Name of its files."""
    episodes: range
    fly: Callable[[], Flights]
    """A function of a module bound to its arguments, so that a worker process can call it."""

    def make(self, place: Path) -> None:
        """Fly and write them; `OSError` when the disk will not."""
        write_flights(place / self.name, self.episodes, self.fly())


def collect(
    folder: Path,
    pools: Sequence[str] = ("nominal", "wind"),
    workers: int = 2,
    episodes: Mapping[str, int] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> dict[str, Path]:
    """Collect `pools` into `folder` and return the file of each pool.

    A finished pool is kept, an unfinished one is completed. `episodes` gives the number of episodes
    of a pool where it is not the paper's; `workers` is the number of processes, 0 for this one.
    `progress` is called with the episodes done and the total of a pool. Raises `UserError` for a
    pool that does not exist, for one that was collected by another recipe, and when `folder` cannot
    be written.
    """
    recipes = {pool: recipe(pool, (episodes or {}).get(pool), seed) for pool in pools}
    return {
        pool: make_pool(folder, pool_recipe, _batches(pool_recipe), workers, progress)
        for pool, pool_recipe in recipes.items()
    }


def recipe(pool: str, episodes: int | None = None, seed: int = 0) -> PoolRecipe:
    """Return what decides a pool's numbers; `UserError` for a pool that cannot be."""
    if pool not in EPISODES:
        raise UserError(f"there is no pool '{pool}': choose from {', '.join(EPISODES)}.")
    count = EPISODES[pool] if episodes is None else episodes
    if count < 1:
        raise UserError(f"pool '{pool}' cannot have {count} episodes: ask for at least one.")
    return PoolRecipe(pool=pool, episodes=count, seed=seed, code_sha256=code_of())


def is_there(path: Path, expected: PoolRecipe) -> bool:
    """Return whether a pool is finished; `UserError` for one of another recipe."""
    provenance = read_provenance(path)
    if provenance is None:
        return False
    for field in PoolRecipe.model_fields:
        if getattr(provenance, field) != getattr(expected, field):
            how = "by other code" if field == "code_sha256" else f"with another '{field}'"
            raise UserError(
                f"the pool at {path} was collected {how}, with faultpath "
                f"{provenance.faultpath_version}: choose another folder, or delete its "
                f"{path.stem}.json to collect it again."
            )
    return True


def make_pool(
    folder: Path,
    recipe: PoolRecipe,
    batches: Sequence[EpisodeBatch],
    workers: int,
    progress: Progress | None = None,
) -> Path:
    """Fly the batches of a pool that are missing, join them, and return the file of its rows.

    The batches' folder changes with anything that decides them. The number of episodes does not: a
    larger pool uses the batches that are there.
    """
    path = folder / f"{recipe.pool}.parquet"
    content = json.dumps([recipe.model_dump(mode="json", exclude={"episodes"}), packages()])
    place = folder / f".{recipe.pool}-{hashlib.sha256(content.encode()).hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder, _log.warning):
            sweep(folder)
            if is_there(path, recipe):
                return path
            place.mkdir(exist_ok=True)
            sweep(place)
            parts = [
                DataFile(
                    place / f"{batch.name}.rows", partial(batch.make, place), len(batch.episodes)
                )
                for batch in batches
            ]
            make_missing([parts], workers, progress)
            _join(path, recipe, [place / batch.name for batch in batches])
            for old in folder.glob(f".{recipe.pool}-*"):  # also of outdated recipes
                shutil.rmtree(old)
    except OSError as error:
        raise UserError(
            f"cannot write to {folder} ({error.strerror}): choose a folder that you may write to "
            "and that has room."
        ) from error
    return path


def _join(path: Path, recipe: PoolRecipe, stems: Sequence[Path]) -> None:
    """Write a finished pool, its provenance last."""
    rows, episodes = join_flights(stems)
    provenance = PoolProvenance(
        **dict(recipe),
        faultpath_version=__version__,
        packages=packages(),
        rows_sha256=hashlib.sha256(rows).hexdigest(),
        episodes_sha256=hashlib.sha256(episodes).hexdigest(),
    )
    write(episodes_path(path), episodes)
    write(path, rows)
    write(provenance_path(path), provenance.encode())


def _batches(recipe: PoolRecipe) -> list[EpisodeBatch]:
    every = range(recipe.episodes)
    parts = (every[first : first + BATCH] for first in every[::BATCH])
    return [
        EpisodeBatch(
            f"{part.start:06d}+{len(part)}", part, partial(fly, recipe.pool, part, recipe.seed)
        )
        for part in parts
    ]
