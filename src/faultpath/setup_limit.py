"""How long a system may take to be built, in a command's own process and in its workers."""

import math
import signal
import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager, redirect_stdout
from types import FrameType
from typing import NoReturn

from faultpath.errors import UserError

LONGEST_S = 3600.0
"""For anything, unless the user or the system says otherwise."""
LEAST_S = 300.0
"""Whatever the user says of a block: imports wait for a busy machine."""
_MOST_S = 1e8


class _TooLate(BaseException):
    """No `Exception`: the code that it interrupts may catch those."""


_observers: list[Callable[[str], None]] = []


def observe(observer: Callable[[str], None]) -> None:
    """Keep somebody informed of what this command is doing, should its process end there."""
    _observers[:] = [observer]


def setup_s(asked_s: float | None) -> float:
    """Return the seconds that set-up may take where a block may take `asked_s`."""
    return LONGEST_S if asked_s is None else min(max(LEAST_S, asked_s), _MOST_S)


def check_limit(asked_s: float | None) -> None:
    """Raise `UserError` for what limits no time."""
    if asked_s is not None and not (math.isfinite(asked_s) and asked_s > 0):
        raise UserError(f"the time limit is {asked_s:g} s: give a number of seconds above 0")


@contextmanager
def setup_limit(what: str, asked_s: float | None) -> Generator[None]:
    """Interrupt what takes too long to be built, `what` by name; `UserError` says so.

    For commands: it takes the process's alarm clock, and puts it back. Python code is interrupted,
    a library that never returns to it is not; Ctrl-C has the same bounds. Off the main thread it
    does nothing, since signals arrive there alone. What is printed meanwhile goes to standard
    error: standard output belongs to the command.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    check_limit(asked_s)
    seconds = setup_s(asked_s)
    before = signal.signal(signal.SIGALRM, _ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    place = what.rpartition(":")[0] or what
    for observer in _observers:
        observer(f"loading {place}")
    try:
        with redirect_stdout(sys.stderr):
            yield
    except _TooLate:
        raise too_late(what, seconds) from None
    finally:
        for observer in _observers:
            observer(f"running {place}")
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def too_late(what: str, seconds: float, where: str = "") -> UserError:
    """Return what to say of a system that was not built in time."""
    return UserError(
        f"system {what!r} was not built{where} within {seconds:g} s: look for what its factory or "
        "its file waits for, or allow more with --time-limit"
    )


def _ring(number: int, frame: FrameType | None) -> NoReturn:
    raise _TooLate
