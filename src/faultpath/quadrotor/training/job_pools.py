"""The pools of data that models are fitted on: which are there, of which code, and making them."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from faultpath.errors import UserError
from faultpath.quadrotor.checkpoint import checkpoint_path
from faultpath.quadrotor.training import clearance_data, trajectories
from faultpath.quadrotor.training.catalogue import CLEARANCE_POOL, Job
from faultpath.quadrotor.training.collection import collect, different, recipe
from faultpath.quadrotor.training.provenance import (
    code_sha256,
    provenance_path,
    read_provenance,
)


def missing_pools(jobs: Sequence[Job], data: Path) -> tuple[str, ...]:
    """Return the pools that some jobs need and the folder does not hold whole."""
    pools = dict.fromkeys(pool for job in jobs for pool in job.entry.pools)
    return tuple(pool for pool in pools if not provenance_path(data / pool).is_file())


def check_pools(jobs: Sequence[Job], data: Path) -> None:
    """Raise `UserError` where a pool that some jobs need was collected by other code than this, or
    for another platform."""
    for pool in dict.fromkeys(pool for job in jobs for pool in job.entry.pools):
        path = data / f"{pool}.parquet"
        if pool == CLEARANCE_POOL or (found := read_provenance(path)) is None:
            continue  # the depth images are checked where they are read
        flown = pool == trajectories.POOL
        code = trajectories.code_sha256() if flown else code_sha256()
        if found.code_sha256 != code:
            raise UserError(
                f"the pool at {path} was collected by other code than this, with faultpath "
                f"{found.faultpath_version}: delete {path.with_suffix('.json')} to collect it "
                "again, or give another folder of data"
            )
        asked = None if flown else recipe(pool)
        if asked and {"flight", "vehicle", "wind"} & set(different(found, asked)):
            raise UserError(
                f"the pool at {path} was collected for another platform than this: give "
                "another folder of data"
            )


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
