"""A worker process: builds the system that it is told, then runs what the parent sends."""

import faulthandler
import os
import signal
import threading
import traceback
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pickle import PicklingError
from typing import Any

from faultpath.blame import described, explained
from faultpath.code import Code, CodeState, Reads, Watch
from faultpath.execution.attempt import Raised, Wrong, attempt
from faultpath.execution.changes import check_same, watched
from faultpath.trials.arm import Arm, SystemSpec
from faultpath.trials.registry import load_system
from faultpath.trials.state import source_state, system_code
from faultpath.trials.system import System


@dataclass(frozen=True)
class Hello:
    """What to build: a system, and the library whose scenes it will run."""

    system: SystemSpec
    library: str


@dataclass(frozen=True)
class Order:
    """An arm over some scenes."""

    arm: Arm
    scenes: tuple[str, ...]
    guard: bool = False


@dataclass(frozen=True)
class Ready:
    """The system is built: the state of its code, and the hash of its library."""

    state: CodeState
    library_hash: str


@dataclass(frozen=True)
class Undeclared:
    """Files that the system has read and does not name among its data files."""

    paths: tuple[str, ...]


@dataclass(frozen=True)
class _Built:
    system: System
    code: Code
    unread: Watch


def main(channel: int, lifeline: int) -> None:
    """Serve the parent over the socket `channel` until it is closed.

    Nothing is ever written to the pipe `lifeline`. It ends when the parent is gone, however it
    went, and this process then ends as well, in the middle of its work.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what Ctrl-C means
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    faulthandler.enable()
    threading.Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    with Connection(channel) as parent, suppress(EOFError, ConnectionError):
        _serve(parent)


def _serve(parent: "Connection[Any, Any]") -> None:
    built: _Built | None = None
    reads = Reads()
    reads.start()
    while True:
        message: Hello | Order = parent.recv()
        if isinstance(message, Hello):
            built, reply = _build(message, reads)
        else:
            assert built is not None  # whoever built none has said so and is sent nothing
            reply = watched(
                built.unread, attempt(built.system, message.arm, message.scenes, message.guard)
            )
            if undeclared := reads.undeclared(built.code):
                parent.send(Undeclared(undeclared))
        if isinstance(reply, Wrong):  # its traceback cannot be sent otherwise
            reply.error.add_note("".join(traceback.format_exception(reply.error)))
        try:
            parent.send(reply)
        except (PicklingError, TypeError, AttributeError) as error:
            parent.send(Raised(f"{type(error).__name__}: {error}", traceback.format_exc()))


def _build(hello: Hello, reads: Reads) -> tuple[_Built | None, Ready | Wrong | Raised]:
    try:
        before = source_state(hello.system)
        reads.forget()
        system = load_system(hello.system)
        built = reads.opened()
        library = system.library(hello.library)
        code = system_code(system, hello.system)
        reads.forget(built)  # scenes have a hash of their own
        check_same(before, code.state)
        return _Built(system, code, code.unread()), Ready(code.state, library.content_hash)
    except (Exception, SystemExit) as error:
        if mistake := explained(error):
            return None, Wrong(mistake)
        return None, Raised(described(error), traceback.format_exc())


def _end_with(lifeline: int) -> None:
    os.read(lifeline, 1)
    os._exit(1)
