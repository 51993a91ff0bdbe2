"""The pools of data that models are fitted on: which are there, of which code, and making them."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from faultpath_quadrotor.checkpoint import checkpoint_path
from faultpath_quadrotor.training import clearance_data, trajectories
from faultpath_quadrotor.training.catalogue import CLEARANCE_POOL, Job
from faultpath_quadrotor.training.collection import collect, is_there, recipe
from faultpath_quadrotor.training.provenance import provenance_path


def missing_pools(jobs: Sequence[Job], data: Path) -> tuple[str, ...]:
    """Return the pools that some jobs need and the folder does not hold whole."""
    pools = dict.fromkeys(pool for job in jobs for pool in job.entry.pools)
    return tuple(pool for pool in pools if not provenance_path(data / pool).is_file())


def check_pools(jobs: Sequence[Job], data: Path) -> None:
    """Raise `UserError` where a pool that some jobs need was made by other code, or otherwise."""
    for pool in dict.fromkeys(pool for job in jobs for pool in job.entry.pools):
        there = provenance_path(data / pool).is_file()
        if there and pool != CLEARANCE_POOL:  # the depth images are checked where they are read
            asked = trajectories.recipe() if pool == trajectories.POOL else recipe(pool)
            is_there(data / f"{pool}.parquet", asked)


def check_pilots(jobs: Sequence[Job]) -> None:
    """Raise `UserError` where closed-loop flights need a model that the package lacks.

    They are flown with the package's models, among which only `--ship` puts those of this run.
    """
    flying = [job for job in jobs if trajectories.POOL in job.entry.pools]
    for name in {name for job in flying for name in job.entry.after}:
        checkpoint_path(name, trajectories.SEED)


def collect_missing(
    jobs: Sequence[Job],
    data: Path,
    workers: int,
    progress: Callable[[str, float, float], None] | None = None,
) -> None:
    """Collect the pools that are missing: training flights, closed-loop flights, depth images.

    `progress` is called with the name of a pool, what is done of it and what was asked for.
    """
    for pool in missing_pools(jobs, data):
        report = None if progress is None else partial(progress, pool)
        if pool == CLEARANCE_POOL:
            clearance_data.collect(data, workers=workers, progress=report)
        elif pool == trajectories.POOL:
            trajectories.record(data, workers, report)
        else:
            collect(data, [pool], workers, progress=report)
