"""Code of a system runs apart from its caller, whose directory and output it may not take over.

The files that it opens to read are noted, as far as Python opens them.
"""

import os
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager, redirect_stdout, suppress
from functools import cache
from pathlib import Path
from typing import Any

from faultpath.core.trees import kind_of
from faultpath.system.system import System

FOLDER = "_faultpath_folder"
"""Under which name a system keeps the working directory that it entered while it loaded."""

_OTHERS = (
    *("/dev/", "/etc/", "/proc/", "/run/", "/sys/", "/usr/", os.path.expanduser("~/.")),
    *(os.path.realpath(prefix) + os.sep for prefix in (sys.prefix, sys.base_prefix)),
)
"""Places of the machine, of Python, and of what programs keep in hidden folders at home."""
_EVENTS = ("open", "sqlite3.connect")
_LINUX_COARSE = 5  # CLOCK_REALTIME_COARSE of Linux, which `time` does not name
_watching: list[tuple[set[str], set[str]]] = []
"""Files opened to be read and files opened to be written, for each `reads` that is open."""


@contextmanager
def set_apart(system: System | None = None) -> Generator[str]:
    """Yield the working directory, and put it back at the end of the `with` block.

    A loaded `system` runs in the one that it entered. What is printed is no output of a command.
    """
    before = working_directory()
    try:
        if system is not None and (own := vars(system).get(FOLDER)):
            os.chdir(own)
        with redirect_stdout(sys.stderr):
            yield before
    finally:
        if working_directory() != before:
            with suppress(OSError):  # it was removed meanwhile
                os.chdir(before)


def working_directory() -> str:
    """Return the working directory; empty where it was removed."""
    try:
        return os.getcwd()
    except FileNotFoundError:
        return ""


@contextmanager
def reads() -> Generator[set[str]]:
    """Collect the user's files that are opened to be read until the end of the `with` block.

    At its end, those that were written meanwhile, by this process or another, are left out.
    """
    _hook()
    read, written, began = set[str](), set[str](), _file_time_ns()
    _watching.append(watcher := (read, written))
    try:
        yield read
    finally:
        _watching[:] = (other for other in _watching if other is not watcher)
        paths = {os.path.realpath(path) for path in read - written}
        read.clear()
        ended = time.time_ns()
        read |= {
            path
            for path in paths
            if _is_users(path) and not began <= os.stat(path).st_mtime_ns <= ended
        }


def _file_time_ns() -> int:
    """The time now, by the clock that stamps files.

    Linux stamps them with a clock that lags by up to a tick: by the finer one, a file written just
    after `now` would seem to be from before.
    """
    return time.clock_gettime_ns(_LINUX_COARSE) if sys.platform == "linux" else time.time_ns()


@cache
def _hook() -> None:
    sys.addaudithook(_note)  # once: it cannot be taken away again


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if not _watching or event not in _EVENTS or isinstance(arguments[0], int):
        return  # a number is of a file that was opened before
    path, _, flags = arguments if event == "open" else (arguments[0], None, os.O_RDONLY)
    if flags & os.O_NONBLOCK:  # as faultpath opens; the file of a fault has its digest in the fault
        caller = sys._getframe(2).f_back  # pyright: ignore[reportPrivateUsage]
        if caller and caller.f_globals.get("__name__") == "faultpath.faults.recorded":
            return
    for read, written in _watching:
        changes = flags & (os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        (written if changes else read).add(os.path.abspath(os.fsdecode(path)))


def _is_users(path: str) -> bool:
    if path.startswith(_OTHERS) or path.endswith((".py", ".pyc", ".so")):
        return False  # sources count by their trees
    place = Path(path)
    if place.parent.suffix == ".dist-info":  # what is installed, wherever it is
        return False
    return "__pycache__" not in path and place.is_file() and kind_of(place) == "local"
