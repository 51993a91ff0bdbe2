"""Fit many models on several worker processes, each with one thread.

Models are independent, so that the weights do not depend on the number of workers. The folder holds
the finished epochs of each.
"""

import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from faultpath.plugin.data import locked, make_folder, sweep, write_file
from faultpath.plugin.system import Stopped, UserError
from faultpath.plugin.training import FitProgress, read_card
from faultpath.plugin.work import Lost, Returned, local, run_each, send_message
from faultpath_quadrotor import models, native
from faultpath_quadrotor.models import ModelCard, checkpoint_path
from faultpath_quadrotor.training import (
    CLEARANCE_POOL,
    TRAJECTORY_POOL,
    clearance_task,
    trajectories,
)
from faultpath_quadrotor.training.catalogue import FitJob
from faultpath_quadrotor.training.fitting import fit
from faultpath_quadrotor.training.flight import collect, recipe
from faultpath_quadrotor.training.pool import is_there, pool_path


def missing_pools(jobs: Sequence[FitJob], data: Path) -> tuple[str, ...]:
    """Return the pools that some jobs need and the folder lacks.

    Raises `UserError` where a pool was made by other code, or otherwise.
    """
    recipes = {CLEARANCE_POOL: clearance_task.recipe, TRAJECTORY_POOL: trajectories.recipe}
    missing: list[str] = []
    for pool in dict.fromkeys(pool for job in jobs for pool in job.entry.pools):
        path = pool_path(data, pool)
        if not path.is_file():
            missing.append(pool)
        else:
            is_there(path, recipes[pool]() if pool in recipes else recipe(pool))
    return tuple(missing)


def check_pilots(jobs: Sequence[FitJob]) -> None:
    """Raise `UserError` where closed-loop flights need a model that the package lacks.

    They are flown with the package's models, among which only `--ship` puts those of this run.
    """
    flying = [job for job in jobs if TRAJECTORY_POOL in job.entry.pools]
    for name in {name for job in flying for name in job.entry.after}:
        checkpoint_path(name, trajectories.SEED)


def collect_missing(
    pools: Sequence[str], data: Path, workers: int, progress: Callable[[str, float, float], None]
) -> None:
    """Collect pools: training flights, closed-loop flights, depth images.

    `progress` is called with the name of a pool, the amount done and the whole amount.
    """
    for pool in pools:
        report = partial(progress, pool)
        if pool == CLEARANCE_POOL:
            clearance_task.collect(data, workers=workers, progress=report)
        elif pool == TRAJECTORY_POOL:
            trajectories.record(data, workers, report)
        else:
            collect(data, [pool], workers, progress=report)


_TELL_EVERY_S = 0.2


@dataclass(frozen=True)
class FitFailure:
    """A model that was not fitted, why, and the file with the traceback when there is one."""

    job: FitJob
    error: str
    details: Path | None = None


def run_jobs(
    jobs: Sequence[FitJob],
    data: Path,
    out: Path,
    workers: int,
    progress: Callable[[float, str], None],
    notice: Callable[[str], None],
    shipped: bool = False,
) -> tuple[ModelCard | FitFailure, ...]:
    """Fit models, the longest first, from wherever an earlier call left them, into a folder.

    Returns the results of the jobs, in their order. `workers` is the number of processes; 0 fits in
    this one. `progress` is called a few times a second with the share of the work that is done, by
    the costs in the catalogue, and what is at work; `notice` with sentences for the user. `shipped`
    copies each finished model into the package.

    A model that fails does not stop the others. Raises `Stopped` on Ctrl-C and `UserError` when
    nothing can be fitted at all.
    """
    executor = local(workers)
    make_folder(out)
    order = sorted(jobs, key=lambda job: -job.entry.cost)
    running: dict[str, FitProgress] = {}
    results: dict[str, ModelCard | FitFailure] = {}

    def show() -> None:
        shares = {stem: moment.fraction for stem, moment in running.items()}
        shares |= dict.fromkeys(results, 1.0)
        done = sum(job.entry.cost * shares.get(job.stem, 0.0) for job in jobs)
        whole = sum(job.entry.cost for job in jobs)
        epochs = (f"{stem} epoch {moment.epoch + 1}" for stem, moment in running.items())
        progress(done / whole, ", ".join((f"{len(results)}/{len(jobs)} models", *epochs)))

    def receive(place: int, message: FitProgress | str) -> None:
        if isinstance(message, str):
            notice(message)
        else:
            running[order[place].stem] = message
        show()

    try:
        with locked(out, notice), executor:
            sweep(out)
            fits = [partial(fit_job, job, data, out) for job in order]
            for place, end in run_each(executor, fits, receive):
                job = order[place]
                running.pop(job.stem, None)
                results[job.stem] = _result(job, end, out / f"{job.stem}.error.txt")
                if isinstance(end, Returned) and shipped:
                    ship(end.value)
                show()
    except KeyboardInterrupt:
        done = sum(isinstance(result, ModelCard) for result in results.values())
        raise Stopped(
            f"interrupted with {done} of {len(jobs)} models finished; they and the finished "
            f"epochs of the others are kept in {out}; run the same command again to resume."
        ) from None
    return tuple(results[job.stem] for job in jobs)


def _result(job: FitJob, end: Any, details: Path) -> ModelCard | FitFailure:
    if isinstance(end, Returned):
        details.unlink(missing_ok=True)
        return read_card(end.value, ModelCard)
    if isinstance(end, Lost):
        return FitFailure(job, f"{end.how}; its epochs are kept")
    if isinstance(end.error, UserError):
        return FitFailure(job, str(end.error))
    details.write_text("".join(traceback.format_exception(end.error)), encoding="utf-8")
    return FitFailure(job, f"{type(end.error).__name__}: {end.error}", details)


@native.using(native.PORTABLE)
def fit_job(job: FitJob, data: Path, out: Path) -> Path:
    """Fit a model and return its file; report progress a few times a second."""
    reported_s = 0.0

    def advance(moment: FitProgress) -> None:
        nonlocal reported_s
        if time.monotonic() - reported_s > _TELL_EVERY_S:
            reported_s = time.monotonic()
            send_message(moment)

    return fit(job.task(data), out, advance, send_message)


def ship(path: Path) -> None:
    """Copy a checkpoint and its card into the package; `UserError` when that is not writable."""
    package = models.shipped_folder()
    make_folder(package)
    for file in (path, path.with_suffix(".json")):
        write_file(package / file.name, file.read_bytes())
