"""A worker process: runs the calls that its parent sends, one after the other."""

import faulthandler
import os
import pickle
import signal
import sys
import threading
import traceback
import warnings
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from typing import Any

from faultpath.core.errors import Notice
from faultpath.core.prints import show_warning
from faultpath.trials.work.executor import Failed, OnMessage, Returned, ended, tell


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
    with Connection(channel) as parent, suppress(EOFError, ConnectionError):
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
