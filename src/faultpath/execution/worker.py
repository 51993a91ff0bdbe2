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

from faultpath.errors import UserError
from faultpath.execution.attempt import Raised, Wrong, attempt, limit_threads
from faultpath.trials.arm import Arm, SystemSpec
from faultpath.trials.registry import load_system
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


@dataclass(frozen=True)
class Ready:
    """The system is built, and these are its fingerprint and the hash of its library."""

    fingerprint: str
    library_hash: str


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
    system: System | None = None
    while True:
        message: Hello | Order = parent.recv()
        if isinstance(message, Hello):
            system, reply = _build(message)
        else:
            assert system is not None  # whoever built none has said so and is sent nothing
            reply = attempt(system, message.arm, message.scenes)
        try:
            parent.send(reply)
        except (PicklingError, TypeError, AttributeError) as error:
            parent.send(Raised(f"{type(error).__name__}: {error}", traceback.format_exc()))


def _build(hello: Hello) -> tuple[System | None, Ready | Wrong | Raised]:
    try:
        system = load_system(hello.system)
        limit_threads()
        library = system.library(hello.library)
        return system, Ready(system.fingerprint(), library.content_hash)
    except UserError as error:
        return None, Wrong(error)
    except Exception as error:
        return None, Raised(f"{type(error).__name__}: {error}", traceback.format_exc())


def _end_with(lifeline: int) -> None:
    os.read(lifeline, 1)
    os._exit(1)
