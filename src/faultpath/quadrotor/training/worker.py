"""A process that fits one model and tells its parent how it goes."""

import os
import signal
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import torch

from faultpath.errors import UserError
from faultpath.quadrotor import native
from faultpath.quadrotor.training.catalogue import Job
from faultpath.quadrotor.training.fitting import Moment, fit

_TELL_EVERY_S = 0.2


@dataclass(frozen=True)
class Places:
    """Folders that a fit reads and writes."""

    data: Path
    out: Path
    tensorboard: Path | None = None


@dataclass(frozen=True)
class Order:
    """What to fit, and where."""

    job: Job
    places: Places


@dataclass(frozen=True)
class Told:
    """A sentence for the user."""

    text: str


@dataclass(frozen=True)
class Finished:
    """The weights file is there."""

    path: Path


@dataclass(frozen=True)
class Failed:
    """The fit ended without weights: a sentence, and the traceback unless it was a mistake."""

    error: str
    details: str = ""


Message = Moment | Told | Finished | Failed


@native.using(native.PORTABLE)
def attempt(order: Order, tell: Callable[[Message], None]) -> Finished | Failed:
    """Fit a model and say how it ended; `tell` gets the news on the way, a few times a second."""
    torch.set_num_threads(1)
    told = 0.0

    def advance(moment: Moment) -> None:
        nonlocal told
        if time.monotonic() - told > _TELL_EVERY_S:
            told = time.monotonic()
            tell(moment)

    places = order.places
    try:
        task = order.job.task(places.data)
        path = fit(task, places.out, advance, places.tensorboard, lambda text: tell(Told(text)))
    except UserError as error:
        return Failed(str(error))
    except Exception as error:
        return Failed(f"{type(error).__name__}: {error}", traceback.format_exc())
    return Finished(path)


def main(channel: int) -> None:
    """Serve the one order that comes over the socket `channel`, and end with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what Ctrl-C means
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    parent: Connection[Any, Any] = Connection(channel)
    with suppress(EOFError, ConnectionError):
        order: Order = parent.recv()
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
        parent.send(attempt(order, parent.send))


def _end_with(parent: "Connection[Any, Any]") -> None:
    """End this process when the parent is gone: it sends nothing after the order."""
    with suppress(EOFError, OSError):
        parent.recv()
    os._exit(1)
