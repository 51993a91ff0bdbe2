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
from faultpath.core.text import show_warning
from faultpath.run.work.executor import (
    ONE_THREAD,
    Call,
    End,
    Executor,
    Failed,
    Here,
    Lost,
    OnMessage,
    ended,
    ignore,
    send_message,
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

_SIGNALS = {number.value: number.name for number in signal.Signals}
"""Most signals of real time have no name."""

_BOOT = (
    "import sys; from faultpath.run.work.processes import main; "
    "main(int(sys.argv[1]), int(sys.argv[2]))"
)


def passed_on(message: tuple[Any], on_message: OnMessage) -> None:
    """Show a notice of a worker's, once for all workers; hand over what else its call tells."""
    (content,) = message
    if isinstance(content, Notice):
        warnings.warn(content, stacklevel=2)  # which shows the same text once
    else:
        on_message(content)


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
        if process is None or process.popen.poll() is not None:
            self.cancel(worker)
            process = self._processes[worker] = _Process()
        with suppress(OSError):  # a process that died already shows when we read
            process.channel.send_bytes(packed)
        self._busy[worker] = on_message

    def completions(self, timeout_s: float) -> Iterator[tuple[int, End]]:
        """Wait for the processes; one that was lost is started anew with its next call."""
        channels = {self._processes[worker].channel: worker for worker in self._busy}
        for channel in connections.wait(list(channels), timeout_s):
            worker = next(w for c, w in channels.items() if c is channel)
            process = self._processes[worker]
            try:
                message: tuple[Any] | End = process.channel.recv()
            except (EOFError, OSError):
                message = Lost(process.exit_reason())
            if isinstance(message, tuple):
                passed_on(message, self._busy[worker])
                continue
            del self._busy[worker]
            if isinstance(message, Lost):
                self.cancel(worker)
            yield worker, message

    def cancel(self, worker: int) -> None:
        """Kill the process."""
        self._busy.pop(worker, None)
        if process := self._processes.pop(worker, None):
            process.popen.kill()
            process.popen.wait()
            process.channel.close()
            os.close(process.lifeline)


class _Process:
    """One process, the socket to it, and our end of its lifeline.

    It is started by command, not by `multiprocessing`: its environment limits numpy and torch to
    one thread before either is imported, and the user's script is not imported again.
    """

    def __init__(self) -> None:
        ours, theirs = socket.socketpair()
        lifeline, self.lifeline = os.pipe()
        path = os.pathsep.join(entry for entry in sys.path if entry)
        output = sys.__stderr__ or subprocess.DEVNULL  # standard error may be closed
        # A blocked signal stays blocked in the child until it says how it takes it.
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self.popen = subprocess.Popen(
                [sys.executable, "-P", "-c", _BOOT, str(theirs.fileno()), str(lifeline)],
                pass_fds=(theirs.fileno(), lifeline),
                env={**KEEP_MEMORY, **os.environ, **ONE_THREAD, "PYTHONPATH": path},
                stdin=subprocess.DEVNULL,
                stdout=output,  # our standard output belongs to the command
                stderr=output,
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            theirs.close()
            os.close(lifeline)
        self.channel: connections.Connection[Any, Any] = connections.Connection(ours.detach())

    def exit_reason(self) -> str:
        """Say how it ended."""
        try:
            code = self.popen.wait(timeout=10)
        except subprocess.TimeoutExpired:
            return "the worker process fell silent"
        if code >= 0:
            return f"the worker process ended by itself with status {code}"
        hint = ", often for want of memory" if code == -signal.SIGKILL else ""
        name = _SIGNALS.get(-code, f"signal {-code}")
        return f"the worker process was ended by {name}{hint}"


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

    def end_with_parent() -> None:
        os.read(lifeline, 1)
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
    with connections.Connection(channel) as parent, suppress(EOFError, ConnectionError):
        while True:
            packed = parent.recv_bytes()
            parent.send_bytes(served(packed, lambda message: parent.send((message,))))


def show(message: Warning | str, *more: Any, **named: Any) -> None:
    """Hand a notice to the parent, which shows it once; show other warnings in a line."""
    if isinstance(message, Notice):
        send_message(message)
    else:
        show_warning(message, *more, **named)


def served(packed: bytes, on_message: OnMessage) -> memoryview:
    """Run a packed call and return its end, packed; `on_message` gets what it tells."""
    try:
        # The call is of the parent, on a way that nobody else has: no file.
        end = ended(pickle.loads(packed), on_message)
    except Exception as error:
        end = Failed(error)
    try:
        if isinstance(end, Failed):
            # A traceback is not sent, and not every error that can be packed can be unpacked.
            end.error.add_note("".join(traceback.format_exception(end.error)))
            pickle.loads(ForkingPickler.dumps(end))
        return ForkingPickler.dumps(end)
    except Exception as error:
        cause = end.error if isinstance(end, Failed) else error
        substitute = RuntimeError(f"{type(cause).__name__}: {cause}")
        substitute.__notes__ = getattr(cause, "__notes__", [])
        return ForkingPickler.dumps(Failed(substitute))
