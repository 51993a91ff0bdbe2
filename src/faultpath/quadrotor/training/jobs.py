"""Fit many models on several worker processes, each with one thread.

Models are independent, so that the weights do not depend on the number of workers. A process fits
one model and ends; what it finished of it, epoch by epoch, is in the folder.
"""

import multiprocessing.connection as connections
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from faultpath.errors import UserError
from faultpath.quadrotor.card import ModelCard, read_card
from faultpath.quadrotor.checkpoint import ship
from faultpath.quadrotor.training.catalogue import Job
from faultpath.quadrotor.training.fitting import Moment, forget
from faultpath.quadrotor.training.job_pools import check_pools
from faultpath.quadrotor.training.pace import Overview, Pace
from faultpath.quadrotor.training.scalars import require_tensorboard
from faultpath.quadrotor.training.worker import (
    Failed,
    Finished,
    Message,
    Order,
    Places,
    Told,
    attempt,
)
from faultpath.store.atomic import sweep
from faultpath.store.lock import locked

_TICK_S = 0.5
_ONE_THREAD = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
_BOOT = "import sys; from faultpath.quadrotor.training.worker import main; main(int(sys.argv[1]))"


class Interrupted(Exception):
    """Ctrl-C stopped the work; finished models and epochs are stored."""

    def __init__(self, done: int, total: int) -> None:
        super().__init__(f"interrupted with {done} of {total} models finished")
        self.done = done
        self.total = total


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

    `workers` is the number of processes; 0 fits in this one. `progress` is called about twice a
    second, `notice` with sentences for the user. `shipped` copies each finished model into the
    package; `force` removes what the folder holds of the models first.

    A model that fails does not stop the others. Raises `Interrupted` on Ctrl-C and `UserError`
    when nothing can be fitted at all.
    """
    if workers < 0:
        raise UserError(f"the number of workers is {workers}: use 0 (this process) or more")
    check_pools(jobs, places.data)
    if places.tensorboard is not None:
        require_tensorboard()
    try:
        places.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(
            f"cannot create {places.out} ({error.strerror}): choose a place that you may write to."
        ) from error
    ledger = _Ledger(jobs, places, max(workers, 1), progress, notice, shipped)
    try:
        with locked(places.out, notice):
            sweep(places.out)
            for job in jobs if force else ():
                forget(job.entry.name, job.seed, places.out)
            if workers == 0:
                _run_here(ledger)
            else:
                _run_with(ledger, workers)
    except KeyboardInterrupt:
        raise Interrupted(len(ledger.cards), len(jobs)) from None
    return ledger.report()


class _Ledger:
    """Which jobs wait, run and are settled."""

    def __init__(
        self,
        jobs: Sequence[Job],
        places: Places,
        workers: int,
        progress: Callable[[Overview], None],
        notice: Callable[[str], None],
        shipped: bool,
    ) -> None:
        self._jobs = tuple(jobs)
        self._waiting = sorted(jobs, key=lambda job: -job.entry.cost)
        self._places = places
        self._progress = progress
        self._notice = notice
        self._shipped = shipped
        self._failures: dict[str, Failure] = {}
        self._pace = Pace(jobs, workers)
        self.cards: dict[str, ModelCard] = {}

    @property
    def settled(self) -> bool:
        """Whether every job has ended."""
        return len(self.cards) + len(self._failures) == len(self._jobs)

    def take(self) -> Order | None:
        """Return the longest job that waits, or None when none is left."""
        if not self._waiting:
            return None
        job = self._waiting.pop(0)
        self._pace.start(job)
        return Order(job, self._places)

    def tell(self, job: Job, message: Message) -> None:
        """Take in what a fit says."""
        if isinstance(message, Moment):
            self._pace.advance(job, message)
        elif isinstance(message, Told):
            self._notice(message.text)
        else:
            self.settle(job, message)

    def settle(self, job: Job, message: Finished | Failed) -> None:
        """Note how a job ended."""
        self._pace.end(job)
        details = self._places.out / f"{job.stem}.error.txt"
        if isinstance(message, Finished):
            details.unlink(missing_ok=True)
            self.cards[job.stem] = read_card(message.path)
            if self._shipped:
                ship(message.path)
            return
        if message.details:
            details.write_text(message.details, encoding="utf-8")
        where = details if message.details else None
        self._failures[job.stem] = Failure(job, message.error, where)

    def show(self) -> None:
        """Say how far everything is."""
        self._progress(self._pace.overview())

    def report(self) -> Report:
        """Return what came of the jobs."""
        stems = [job.stem for job in self._jobs]
        return Report(
            tuple(self.cards[stem] for stem in stems if stem in self.cards),
            tuple(self._failures[stem] for stem in stems if stem in self._failures),
        )


def _run_here(ledger: _Ledger) -> None:
    while order := ledger.take():

        def tell(message: Message, job: Job = order.job) -> None:
            ledger.tell(job, message)
            ledger.show()

        tell(attempt(order, tell))


def _run_with(ledger: _Ledger, workers: int) -> None:
    running: list[_Process] = []
    try:
        while not ledger.settled:
            while len(running) < workers and (order := ledger.take()):
                running.append(_Process(order))
            ready = connections.wait([each.channel for each in running], _TICK_S)
            for process in [each for each in running if each.channel in ready]:
                message = process.receive()
                ledger.tell(process.job, message)
                if isinstance(message, Finished | Failed):
                    running.remove(process)
                    process.stop()
            ledger.show()
    finally:
        for process in running:
            process.stop()


class _Process:
    """A worker process and the job that it is at.

    Started by command rather than by `multiprocessing`: the environment limits numpy and torch to
    one thread before either is imported, and the user's script is not imported again.
    """

    def __init__(self, order: Order) -> None:
        self.job = order.job
        ours, theirs = socket.socketpair()
        path = os.pathsep.join(entry for entry in sys.path if entry)
        environment = {**os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": path}
        # A blocked signal stays blocked in the child until it says how it takes it.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _BOOT, str(theirs.fileno())],
                pass_fds=(theirs.fileno(),),
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=sys.__stderr__,  # our standard output belongs to the command
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            theirs.close()
        self.channel: connections.Connection[Any, Any] = connections.Connection(ours.detach())
        with suppress(OSError):  # a process that died already shows when we read
            self.channel.send(order)

    def receive(self) -> Message:
        """Return the next message, or that the process ended without one."""
        try:
            return self.channel.recv()
        except (EOFError, OSError):
            status = self._process.wait()
            hint = ", often for want of memory" if status == -signal.SIGKILL else ""
            return Failed(f"its process ended with status {status}{hint}; its epochs are kept")

    def stop(self) -> None:
        """End the process now; harmless when it has ended."""
        self._process.kill()
        self._process.wait()
        self.channel.close()
