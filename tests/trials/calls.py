"""Calls for workers; they are module-level functions, as any call that is sent away has to be."""

import os
import signal
import sys
import time
from pathlib import Path

from faultpath.trials.work.executor import tell

_seen: list[int] = []


def double(number: int) -> int:
    return 2 * number


def remember(number: int) -> list[int]:
    _seen.append(number)
    return list(_seen)


def count(upto: int) -> int:
    for number in range(upto):
        tell(number)
    return upto


def settings() -> tuple[int, str | None, str | None, int]:
    names = ("OMP_NUM_THREADS", "MKL_NUM_THREADS")
    return os.getpid(), *map(os.environ.get, names), os.getpgrp()


def hang(log: Path | None = None) -> None:
    if log is not None:
        log.with_name(f"{os.getpid()}.pid").touch()
    time.sleep(600)


def leave(how: str) -> object:
    match how:
        case "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        case "exit":
            sys.exit(3)
        case "_exit":
            os._exit(0)
        case "raise":
            raise ValueError("no air")
        case "shy":
            raise Shy(1, 2)
        case "closure":
            return lambda: 1
    return None


class Shy(Exception):
    """An error that can be packed and not unpacked."""

    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"{one} and {two}")
