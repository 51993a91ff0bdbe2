"""The pools of training flights: how many episodes each has, and who flies them."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from faultpath.plugin.system import UserError
from faultpath_quadrotor.training.flight import fly
from faultpath_quadrotor.training.parts import Progress
from faultpath_quadrotor.training.pool import PoolPart, PoolRecipe, code_of, make_pool

EPISODES = {"nominal": 7_150, "wind": 14_891}  # paper, Section IV-A
BATCH = 1024
"""Episodes flown together. The plant's cost a vehicle still falls beyond this; a larger batch would
need more memory for its winds, and a kill would lose more."""


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
    paths: dict[str, Path] = {}
    for pool, pool_recipe in recipes.items():
        every = range(pool_recipe.episodes)
        batches = [every[first : first + BATCH] for first in every[::BATCH]]
        parts = [
            PoolPart(f"{batch.start:06d}+{len(batch)}", len(batch), partial(fly, pool, batch, seed))
            for batch in batches
        ]
        paths[pool] = make_pool(folder, pool_recipe, parts, workers, progress)
    return paths


def recipe(pool: str, episodes: int | None = None, seed: int = 0) -> PoolRecipe:
    """Return what decides a pool's numbers; `UserError` for a pool that cannot be."""
    if pool not in EPISODES:
        raise UserError(f"there is no pool '{pool}': choose from {', '.join(EPISODES)}.")
    count = EPISODES[pool] if episodes is None else episodes
    if count < 1:
        raise UserError(f"pool '{pool}' cannot have {count} episodes: ask for at least one.")
    return PoolRecipe(pool=pool, episodes=count, seed=seed, code_sha256=code_of())
