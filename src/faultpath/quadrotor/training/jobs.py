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
from faultpath.work import End, Executor, Lost, Returned, local, tell

_TICK_S = 0.5
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
    fits = _Fits(jobs, places, progress, notice, shipped)
    try:
        with locked(places.out, notice):
            sweep(places.out)
            for job in jobs if force else ():
                forget(job.entry.name, job.seed, places.out)
            with executor:
                _run(fits, executor)
    except KeyboardInterrupt:
        again = "without --force " if force else ""
        raise Stopped(
            f"interrupted with {len(fits.cards)} of {len(jobs)} models finished; they and the "
            f"finished epochs of the others are kept in {places.out}; run the same command "
            f"{again}again to resume."
        ) from None
    return fits.report()


class _Fits:
    """Which jobs wait, run and are settled."""

    def __init__(
        self,
        jobs: Sequence[Job],
        places: Places,
        progress: Callable[[Overview], None],
        notice: Callable[[str], None],
        shipped: bool,
    ) -> None:
        self._jobs = tuple(jobs)
        self._waiting = sorted(jobs, key=lambda job: -job.entry.cost)
        self.places = places
        self._progress = progress
        self._notice = notice
        self._shipped = shipped
        self._failures: dict[str, Failure] = {}
        self._running: dict[str, Moment | None] = {}
        self._ended: set[str] = set()
        self.cards: dict[str, ModelCard] = {}

    def take(self) -> Job | None:
        """Return the longest job that waits, or None when none is left."""
        if not self._waiting:
            return None
        job = self._waiting.pop(0)
        self._running[job.stem] = None
        return job

    def tell(self, job: Job, message: Moment | str) -> None:
        """Take in what a fit says: how far it is, or a sentence for the user."""
        if isinstance(message, str):
            self._notice(message)
        else:
            self._running[job.stem] = message
        self.show()

    def settle(self, job: Job, end: End) -> None:
        """Note how a job ended."""
        del self._running[job.stem]
        self._ended.add(job.stem)
        details = self.places.out / f"{job.stem}.error.txt"
        if isinstance(end, Returned):
            details.unlink(missing_ok=True)
            self.cards[job.stem] = read_card(end.value)
            if self._shipped:
                ship(end.value, job.platform)
        elif isinstance(end, Lost):
            self._failures[job.stem] = Failure(job, f"{end.how}; its epochs are kept")
        elif isinstance(end.error, UserError):
            self._failures[job.stem] = Failure(job, str(end.error))
        else:
            said = f"{type(end.error).__name__}: {end.error}"
            details.write_text("".join(traceback.format_exception(end.error)), encoding="utf-8")
            self._failures[job.stem] = Failure(job, said, details)
        self.show()

    def show(self) -> None:
        """Say how far everything is."""
        parts = dict.fromkeys(self._ended, 1.0)
        parts |= {stem: moment.fraction for stem, moment in self._running.items() if moment}
        done = sum(job.entry.cost * parts.get(job.stem, 0.0) for job in self._jobs)
        whole = sum(job.entry.cost for job in self._jobs)
        running = dict(self._running)
        self._progress(Overview(len(self._ended), len(self._jobs), done / whole, running))

    def report(self) -> Report:
        """Return what came of the jobs."""
        stems = [job.stem for job in self._jobs]
        return Report(
            tuple(self.cards[stem] for stem in stems if stem in self.cards),
            tuple(self._failures[stem] for stem in stems if stem in self._failures),
        )


def _run(fits: _Fits, executor: Executor) -> None:
    running: dict[int, Job] = {}
    while True:
        for worker in executor.free():
            if job := fits.take():
                running[worker] = job
                call = partial(fit_job, job, fits.places)
                executor.submit(worker, call, partial(fits.tell, job))
        if not running:
            return
        for worker, end in executor.completions(_TICK_S):
            fits.settle(running.pop(worker), end)
        fits.show()


@native.using(native.PORTABLE)
def fit_job(job: Job, places: Places) -> Path:
    """Fit a model and return its file; a few times a second it tells how far it is."""
    told = 0.0

    def advance(moment: Moment) -> None:
        nonlocal told
        if time.monotonic() - told > _TELL_EVERY_S:
            told = time.monotonic()
            tell(moment)

    return fit(job.task(places.data), places.out, advance, places.tensorboard, tell)
