"""Worker processes on this machine: what their parent sees, and what runs in them."""

import faulthandler
import multiprocessing.connection as connections
import os
import pickle
import signal
import socket
import subprocess
import sys
import threading
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing.reduction import ForkingPickler
from typing import Any

from faultpath.core.errors import Notice, UserError
from faultpath.core.prints import show_warning
from faultpath.trials.work.executor import (
    ONE_THREAD,
    Call,
    End,
    Executor,
    Failed,
    Here,
    Lost,
    OnMessage,
    Returned,
    ended,
    ignore,
    tell,
)

KEEP_MEMORY = {
    "MALLOC_MMAP_THRESHOLD_": str(1 << 28),
    "MALLOC_TRIM_THRESHOLD_": str(1 << 30),
    "MALLOC_TOP_PAD_": str(1 << 26),
}
"""Large blocks stay with the process once freed: glibc would give them back to the system and fault
them in again at the next tensor of that size."""

_MOST = 4096
"""Processes of one machine; more is a slip of the keyboard."""

_BOOT = (
    "import sys; from faultpath.trials.work.processes import main; "
    "main(int(sys.argv[1]), int(sys.argv[2]))"
)


def passed_on(message: tuple[Any], on_message: OnMessage) -> None:
    """Show a notice of a worker's, once for all workers; hand over what else its call tells."""
    (said,) = message
    if isinstance(said, Notice):
        warnings.warn(said, stacklevel=2)  # which shows the same text once
    else:
        on_message(said)


def local(workers: int) -> Executor:
    """Return so many processes of this machine, or for 0 this process itself."""
    if not 0 <= workers <= _MOST:
        raise UserError(
            f"the number of workers is {workers}: use 0 (this process) or more, at most {_MOST}"
        )
    return Processes(workers) if workers else Here()


class Processes(Executor):
    """Runs calls in processes of their own, started when they are needed."""

    def __init__(self, count: int) -> None:
        self.count = count
        self._processes: dict[int, _Process] = {}
        self._busy: dict[int, OnMessage] = {}

    def free(self) -> Sequence[int]:
        """Return the workers without a call, started or not."""
        return [worker for worker in range(self.count) if worker not in self._busy]

    def submit(self, worker: int, call: Call, on_message: OnMessage = ignore) -> None:
        """Send the call, to a new process where there is none that lives."""
        assert worker in self.free()
        packed = ForkingPickler.dumps(call)
        process = self._processes.get(worker)
        if process is None or not process.alive:
            self._end(worker)
            process = self._processes[worker] = _Process()
        process.send(packed)
        self._busy[worker] = on_message

    def completions(self, timeout_s: float) -> Iterator[tuple[int, End]]:
        """Wait for the processes; one that was lost is started anew with its next call."""
        channels = {self._processes[worker].channel: worker for worker in self._busy}
        for channel in connections.wait(list(channels), timeout_s):
            worker = next(w for c, w in channels.items() if c is channel)
            message = self._processes[worker].receive()
            if not isinstance(message, (Returned, Failed, Lost)):
                passed_on(message, self._busy[worker])
                continue
            del self._busy[worker]
            if isinstance(message, Lost):
                self._end(worker)
            yield worker, message

    def cancel(self, worker: int) -> None:
        """Kill the process."""
        del self._busy[worker]
        self._end(worker)

    def _end(self, worker: int) -> None:
        if process := self._processes.pop(worker, None):
            process.stop()

    def close(self) -> None:
        """Kill the processes; what they have written to disk is whole."""
        self._busy.clear()
        for worker in tuple(self._processes):
            self._end(worker)


class _Process:
    """One process.

    It is started by command, not by `multiprocessing`: its environment limits numpy and torch to
    one thread before either is imported, and the user's script is not imported again.
    """

    def __init__(self) -> None:
        ours, theirs = socket.socketpair()
        lifeline, self._lifeline = os.pipe()
        path = os.pathsep.join(entry for entry in sys.path if entry)
        # A blocked signal stays blocked in the child until it says how it takes it.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _BOOT, str(theirs.fileno()), str(lifeline)],
                pass_fds=(theirs.fileno(), lifeline),
                env={**KEEP_MEMORY, **os.environ, **ONE_THREAD, "PYTHONPATH": path},
                stdin=subprocess.DEVNULL,
                stdout=sys.__stderr__,  # our standard output belongs to the command
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            theirs.close()
            os.close(lifeline)
        self.channel: connections.Connection[Any, Any] = connections.Connection(ours.detach())

    @property
    def alive(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def send(self, packed: memoryview) -> None:
        """Send a call; a process that died already shows when we read."""
        with suppress(OSError):
            self.channel.send_bytes(packed)

    def receive(self) -> tuple[Any] | End:
        """Return what it tells, as a tuple of one, or the end of its call."""
        try:
            return self.channel.recv()
        except (EOFError, OSError):
            return Lost(self._obituary())

    def stop(self) -> None:
        """End it now; harmless when it has ended."""
        self._process.kill()
        self._process.wait()
        self.channel.close()
        os.close(self._lifeline)

    def _obituary(self) -> str:
        try:
            code = self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            return "the worker process fell silent"
        if code >= 0:
            return f"the worker process ended by itself with status {code}"
        hint = ", often for want of memory" if code == -signal.SIGKILL else ""
        return f"the worker process was ended by {signal.Signals(-code).name}{hint}"


def main(channel: int, lifeline: int) -> None:
    """Serve the parent over the socket `channel` until it is closed.

    Nothing is ever written to the pipe `lifeline`. It ends when the parent is gone, however it
    went, and this process then ends as well, in the middle of its work.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what Ctrl-C means
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    faulthandler.enable()
    warnings.showwarning = show
    sys.stdout = sys.stderr
    threading.Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    with connections.Connection(channel) as parent, suppress(EOFError, ConnectionError):
        while True:
            packed = parent.recv_bytes()
            parent.send_bytes(served(packed, lambda message: parent.send((message,))))


def show(message: Warning | str, *more: Any, **named: Any) -> None:
    """Hand a notice to the parent, which shows it once; show other warnings in a line."""
    if isinstance(message, Notice):
        tell(message)
    else:
        show_warning(message, *more, **named)


def served(packed: bytes, on_message: OnMessage) -> memoryview:
    """Run a packed call and return its end, packed; `on_message` gets what it tells."""
    try:
        call = pickle.loads(packed)  # of the parent, on a way that nobody else has: no file
    except Exception as error:
        return _packed(Failed(error))
    return _packed(ended(call, on_message))


def _packed(end: Returned | Failed) -> memoryview:
    try:
        if isinstance(end, Failed):
            # A traceback is not sent, and not every error that can be packed can be unpacked.
            end.error.add_note("".join(traceback.format_exception(end.error)))
            pickle.loads(ForkingPickler.dumps(end))
        return ForkingPickler.dumps(end)
    except Exception as error:
        said = end.error if isinstance(end, Failed) else error
        instead = RuntimeError(f"{type(said).__name__}: {said}")
        instead.__notes__ = getattr(said, "__notes__", [])
        return ForkingPickler.dumps(Failed(instead))


def _end_with(lifeline: int) -> None:
    os.read(lifeline, 1)
    os._exit(1)
