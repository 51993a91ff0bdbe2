"""Fit many models on several worker processes, each with one thread.

Models are independent, so that the weights do not depend on the number of workers. What is finished
of one, epoch by epoch, is in the folder.
"""

import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from faultpath.errors import Stopped, UserError
from faultpath.quadrotor import native
from faultpath.quadrotor.card import ModelCard, read_card
from faultpath.quadrotor.checkpoint import ship
from faultpath.quadrotor.training.catalogue import Job
from faultpath.quadrotor.training.fitting import Moment, fit, forget
from faultpath.quadrotor.training.job_pools import check_pools
from faultpath.store import make_folder
from faultpath.store.atomic import sweep
from faultpath.store.lock import locked
from faultpath.work import End, Lost, Returned, local, run_each, tell

_TELL_EVERY_S = 0.2


@dataclass(frozen=True)
class Places:
    """Folders that a fit reads and writes."""

    data: Path
    out: Path
    tensorboard: Path | None = None


@dataclass(frozen=True)
class Failure:
    """A model that was not fitted, why, and the file with the traceback when there is one."""

    job: Job
    error: str
    details: Path | None = None


@dataclass(frozen=True)
class Report:
    """What came of the jobs, in their order."""

    cards: tuple[ModelCard, ...]
    failures: tuple[Failure, ...]


@dataclass(frozen=True)
class Overview:
    """How far all models together are."""

    done: int
    total: int
    fraction: float
    """Part of the work that is done, by the costs in the catalogue."""
    running: Mapping[str, Moment | None]
    """Models at work, as `<name>-<seed>`; `None` until the first minibatch."""


def run_jobs(
    jobs: Sequence[Job],
    places: Places,
    workers: int,
    progress: Callable[[Overview], None],
    notice: Callable[[str], None],
    shipped: bool = False,
    force: bool = False,
) -> Report:
    """Fit models, the longest first, from wherever an earlier call left them.

    `workers` is the number of processes; 0 fits in this one. `progress` is called a few times
    a second, `notice` with sentences for the user. `shipped` copies each finished model into the
    package; `force` removes what the folder holds of the models first.

    A model that fails does not stop the others. Raises `Stopped` on Ctrl-C and `UserError` when
    nothing can be fitted at all.
    """
    executor = local(workers)
    check_pools(jobs, places.data)
    make_folder(places.out)
    order = sorted(jobs, key=lambda job: -job.entry.cost)
    running: dict[str, Moment | None] = {}
    results: dict[str, ModelCard | Failure] = {}

    def show() -> None:
        parts = {stem: moment.fraction for stem, moment in running.items() if moment}
        parts |= dict.fromkeys(results, 1.0)
        done = sum(job.entry.cost * parts.get(job.stem, 0.0) for job in order)
        whole = sum(job.entry.cost for job in order)
        progress(Overview(len(results), len(order), done / whole, dict(running)))

    def told(place: int, message: Moment | str | None) -> None:
        if isinstance(message, str):
            notice(message)
        else:
            running[order[place].stem] = message
        show()

    try:
        with locked(places.out, notice):
            sweep(places.out)
            for job in jobs if force else ():
                forget(job.entry.name, job.seed, places.out)
            with executor:
                calls = [partial(fit_job, job, places) for job in order]
                for place, end in run_each(executor, calls, told):
                    job = order[place]
                    running.pop(job.stem, None)
                    results[job.stem] = _result(job, end, places.out)
                    if shipped and isinstance(end, Returned):
                        ship(end.value)
                    show()
    except KeyboardInterrupt:
        again = "without --force " if force else ""
        done = sum(isinstance(found, ModelCard) for found in results.values())
        raise Stopped(
            f"interrupted with {done} of {len(jobs)} models finished; they and the finished "
            f"epochs of the others are kept in {places.out}; run the same command {again}again to "
            "resume."
        ) from None
    found = [results[job.stem] for job in jobs]
    return Report(
        tuple(each for each in found if isinstance(each, ModelCard)),
        tuple(each for each in found if isinstance(each, Failure)),
    )


def _result(job: Job, end: End, folder: Path) -> ModelCard | Failure:
    details = folder / f"{job.stem}.error.txt"
    if isinstance(end, Returned):
        details.unlink(missing_ok=True)
        return read_card(end.value)
    if isinstance(end, Lost):
        return Failure(job, f"{end.how}; its epochs are kept")
    if isinstance(end.error, UserError):
        return Failure(job, str(end.error))
    details.write_text("".join(traceback.format_exception(end.error)), encoding="utf-8")
    return Failure(job, f"{type(end.error).__name__}: {end.error}", details)


@native.using(native.PORTABLE)
def fit_job(job: Job, places: Places) -> Path:
    """Fit a model and return its file; a few times a second it tells how far it is."""
    tell(None)  # it has begun: its data may take a while
    told = 0.0

    def advance(moment: Moment) -> None:
        nonlocal told
        if time.monotonic() - told > _TELL_EVERY_S:
            told = time.monotonic()
            tell(moment)

    return fit(job.task(places.data), places.out, advance, places.tensorboard, tell)
