"""Worker processes seen from the parent."""

import multiprocessing.connection as connections
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from faultpath.code import named
from faultpath.execution.attempt import Died, Done, Raised, Wrong
from faultpath.execution.changes import check_same
from faultpath.execution.limits import TimeLimit
from faultpath.execution.schedule import Recheck, Task
from faultpath.execution.worker import Hello, Order, Ready, Undeclared
from faultpath.patience import too_late

_ONE_THREAD = (
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
# Large blocks stay with the process once freed: glibc would give them back to the system and fault
# them in again at the next tensor of that size.
KEEP_MEMORY = {
    "MALLOC_MMAP_THRESHOLD_": str(1 << 28),
    "MALLOC_TRIM_THRESHOLD_": str(1 << 30),
    "MALLOC_TOP_PAD_": str(1 << 26),
}
_BOOT = (
    "import sys; from faultpath.execution.worker import main; "
    "main(int(sys.argv[1]), int(sys.argv[2]))"
)


class WorkerLost(Exception):
    """Worker processes cannot be brought up."""


class Worker:
    """One worker process and the task that it is at.

    The process is started by command, not by `multiprocessing`: its environment limits numpy and
    torch to one thread before either is imported, and the user's script is not imported again.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self._greetings = 0
        self.task: Task | None = None
        self.since = 0.0
        ours, theirs = socket.socketpair()
        lifeline, self._lifeline = os.pipe()
        path = os.pathsep.join(entry for entry in sys.path if entry)
        one_thread = dict.fromkeys(_ONE_THREAD, "1")
        environment = {**KEEP_MEMORY, **os.environ, **one_thread, "PYTHONPATH": path}
        # A blocked signal stays blocked in the child until it says how it takes it.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", _BOOT, str(theirs.fileno()), str(lifeline)],
                pass_fds=(theirs.fileno(), lifeline),
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=sys.__stderr__,  # our standard output belongs to the command
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            theirs.close()
            os.close(lifeline)
        self.channel: connections.Connection[Any, Any] = connections.Connection(ours.detach())

    @property
    def ready(self) -> bool:
        """Whether it has built what it was last told to."""
        return self._greetings == 0

    def greet(self, hello: Hello) -> None:
        """Tell it what to build."""
        self._greetings += 1
        self.since = time.monotonic()
        with suppress(OSError):  # a worker that died already shows when we read
            self.channel.send(hello)

    def answered(self) -> None:
        """Note that it has built what one greeting told it to."""
        self._greetings -= 1

    def send(self, task: Task) -> None:
        """Hand a task out."""
        self.task, self.since = task, time.monotonic()
        with suppress(OSError):
            self.channel.send(Order(task.unit.arm, task.scenes, task.recheck is Recheck.GUARDED))

    def receive(self) -> Ready | Undeclared | Done | Raised | Wrong | Died:
        """Return the next message, or how the process ended."""
        try:
            return self.channel.recv()
        except (EOFError, OSError):
            return Died(self._obituary())

    def stop(self) -> None:
        """End the process now; harmless when it has ended."""
        self.process.kill()
        self.process.wait()
        self.channel.close()
        if self._lifeline >= 0:
            os.close(self._lifeline)
            self._lifeline = -1

    def _obituary(self) -> str:
        try:
            code = self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            return "the worker process fell silent"
        if code >= 0:
            return f"the worker process ended by itself with status {code}"
        hint = ", often for want of memory" if code == -signal.SIGKILL else ""
        return f"the worker process was ended by {signal.Signals(-code).name}{hint}"


class Crew:
    """Several workers that serve one system after another; one that dies is replaced."""

    def __init__(self) -> None:
        self._hello: Hello | None = None
        self._expected: Ready | None = None
        self._false_starts = 0
        self._workers: dict[int, Worker] = {}
        self.undeclared: set[str] = set()
        """Files that the system has read and does not name among its data files."""

    def begin(self, hello: Hello, expected: Ready, count: int) -> None:
        """Turn to a system, with at least `count` workers; those that are there already build it.

        Every task of the system before has to be settled.
        """
        self._hello, self._expected, self._false_starts = hello, expected, 0
        self.undeclared.clear()
        for number in range(len(self._workers), count):
            self._workers[number] = Worker(number)
        for worker in self._workers.values():
            worker.greet(hello)

    def __enter__(self) -> "Crew":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def idle(self) -> Iterator[Worker]:
        """Yield the workers that could start a task now."""
        for worker in self._workers.values():
            if worker.ready and worker.task is None:
                yield worker

    def replies(
        self, timeout_s: float, limit: TimeLimit
    ) -> Iterator[tuple[Task, Done | Raised | Wrong | Died]]:
        """Wait for news and yield what came of tasks; a worker past the limit is replaced."""
        channels = {worker.channel: worker for worker in self._workers.values()}
        for channel in connections.wait(list(channels), timeout_s):
            worker = next(w for c, w in channels.items() if c is channel)
            message = worker.receive()
            if isinstance(message, Ready):
                self._welcome(worker, message)
                continue
            if isinstance(message, Undeclared):
                self.undeclared.update(message.paths)
                continue
            task, worker.task = worker.task, None
            if isinstance(message, Died):
                self._replace(worker)
            if task is not None:
                yield task, message
            else:
                self._false_start(message)
        yield from self._late(limit)

    def _late(self, limit: TimeLimit) -> Iterator[tuple[Task, Died]]:
        now = time.monotonic()
        for worker in tuple(self._workers.values()):
            if (task := worker.task) is None:
                if not worker.ready and now - worker.since > limit.building_s:
                    raise too_late(self._name, limit.building_s, " in a worker process")
                continue
            allowed = limit.seconds(len(task.scenes))
            if now - worker.since > allowed:
                self._replace(worker)
                yield task, Died(f"it was stopped at the time limit of {allowed:g} s", late=True)

    def stop(self) -> None:
        """End every worker."""
        for worker in self._workers.values():
            worker.stop()

    def _welcome(self, worker: Worker, message: Ready) -> None:
        worker.answered()
        if not worker.ready:
            return  # it has still to build what it was told since
        if self._expected is not None and message != self._expected:
            check_same(self._expected.state, message.state)
            differ = self._expected.state.changed(message.state) or ("the library",)
            raise WorkerLost(
                f"system {self._name!r} is another one in a worker process than here "
                f"({named(differ)}): nothing of it may depend on the process that builds it"
            )

    def _replace(self, worker: Worker) -> None:
        worker.stop()
        self._workers[worker.number] = successor = Worker(worker.number)
        if self._hello is not None:
            successor.greet(self._hello)

    @property
    def _name(self) -> str:
        return "" if self._hello is None else self._hello.system.name

    def _false_start(self, message: Done | Raised | Wrong | Died) -> None:
        """Give up when workers cannot build the system."""
        if isinstance(message, Wrong):
            raise message.error
        if isinstance(message, Raised):
            raise WorkerLost(
                f"system {self._name!r} cannot be built in a worker process:\n{message.traceback}"
            )
        self._false_starts += 1
        if self._false_starts > 2 * len(self._workers):
            how = message.how if isinstance(message, Died) else "it said nothing of use"
            raise WorkerLost(f"worker processes do not come up: {how}")
