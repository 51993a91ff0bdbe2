"""Calls for workers, at module level as all that is sent away, and how to wait for their ends."""

import os
import signal
import sys
import time
from pathlib import Path

from faultpath.run.work.executor import send_message

_seen: list[int] = []


def alive(pid: int) -> bool:
    """Return whether a process lives, and is not only still listed."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def end_of(executor, call, told=lambda message: None, seconds=120.0):
    """Run one call and return its end."""
    (worker, *_) = executor.free()
    executor.submit(worker, call, told)
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        for ended, end in executor.completions(0.5):
            assert ended == worker
            return end
    raise AssertionError("waited in vain")


def double(number: int) -> int:
    return 2 * number


def remember(number: int) -> list[int]:
    _seen.append(number)
    return list(_seen)


def count(upto: int) -> int:
    for number in range(upto):
        send_message(number)
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
        case "nameless":
            os.kill(os.getpid(), signal.SIGRTMIN + 1)
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
