"""Which files a process opens to read, while something watches.

Seen is what Python opens; a library in another language may open files by itself.
"""

import os
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

from faultpath.trials.imports import kind_of

_CODE = frozenset({".py", ".pyc", ".pyd", ".pyi", ".so"})
"""Imports are followed from the sources."""
_OTHERS = (
    *("/dev/", "/etc/", "/proc/", "/run/", "/sys/", "/usr/", os.path.expanduser("~/.")),
    *(os.path.realpath(prefix) + os.sep for prefix in (sys.prefix, sys.base_prefix)),
)
"""The machine's, Python's, and what programs keep for themselves in the user's home, caches above
all."""
_watching: list[tuple[set[str], set[str]]] = []
"""By whoever watches: what was opened to be read, and what to be made."""


@contextmanager
def reads() -> Generator[set[str]]:
    """Collect the user's files that are opened to be read until the end of the `with` block.

    At its end, those that were written meanwhile, by this process or another, are left out.
    """
    _hook()
    read, made, began = set[str](), set[str](), time.time_ns()
    _watching.append(mine := (read, made))
    try:
        yield read
    finally:
        _watching[:] = (each for each in _watching if each is not mine)
        found = {os.path.realpath(path) for path in read - made}
        read.clear()
        read |= {path for path in found if _is_users(path) and os.stat(path).st_mtime_ns < began}


@cache
def _hook() -> None:
    """Install the hook, once: it cannot be taken away again."""
    sys.addaudithook(_note)


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if not _watching or event != "open":
        return
    path, _, flags = arguments
    if isinstance(path, int) or not isinstance(flags, int):
        return  # a descriptor was opened before
    if flags & os.O_NONBLOCK and getattr(_caller(2).f_back, "f_globals", {}).get("__name__") == (
        _RECORDED
    ):
        return
    for read, made in _watching:
        changes = flags & (os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        (made if changes else read).add(os.path.abspath(os.fsdecode(path)))


_RECORDED = "faultpath.faults.recorded"
"""What reads the file of a fault, whose digest the fault holds."""


_caller: Callable[[int], FrameType] = vars(sys)["_getframe"]


def _is_users(path: str) -> bool:
    place = Path(path)
    return (
        place.suffix not in _CODE
        and not path.startswith(_OTHERS)
        and "__pycache__" not in place.parts
        and place.is_file()
        and kind_of(place) == "local"
    )
