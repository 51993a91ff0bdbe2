"""How long a block may take and how much, and how many failures say that nothing works."""

import sys
from functools import cache
from pathlib import Path

from faultpath.errors import UserError
from faultpath.patience import building_s, check_limit

FIRST_S = 3600.0
"""Until a first block is done nobody knows how long one takes."""
LEAST_S = 300.0
TIMES = 20
_GIB = 2**30
_MOST_GIB = 2**20
FEW = 5
"""So many failed trials without one that ran to its end stop the study."""


class TimeLimit:
    """The seconds that a task may take: as asked, or many times as long as the slowest so far."""

    def __init__(self, asked_s: float | None = None) -> None:
        check_limit(asked_s)
        self._asked_s = asked_s
        self._slowest_s = 0.0
        self._slowest_scene_s = 0.0

    @property
    def building_s(self) -> float:
        """The seconds that a worker may take to build the system."""
        return building_s(self._asked_s)

    def learn(self, seconds: float, scenes: int) -> None:
        """Take in how long a finished task took."""
        self._slowest_s = max(self._slowest_s, seconds)
        self._slowest_scene_s = max(self._slowest_scene_s, seconds / scenes)

    def seconds(self, scenes: int) -> float:
        """Return the limit of a task of so many scenes."""
        if self._asked_s is not None:
            return self._asked_s
        if not self._slowest_s:
            return FIRST_S
        return max(LEAST_S, TIMES * max(self._slowest_s, self._slowest_scene_s * scenes))


def memory_limit(asked_gib: float | None, default_gib: float | None) -> float | None:
    """Return the GiB that a worker may take, as asked or as the system says; `None`: no limit.

    Raises `UserError` for a number that is none, and where the machine cannot hold a process to
    it; a default of the system is passed over there.
    """
    found = default_gib if asked_gib is None else asked_gib
    if found is None:
        return None
    if not 0 < found <= _MOST_GIB:
        raise UserError(
            f"the memory limit is {found:g} GiB: give a number above 0, at most {_MOST_GIB:,}"
        )
    if sys.platform != "linux":
        if asked_gib is not None:
            raise UserError("a memory limit needs Linux: leave it out here")
        return None
    return found


def hold_to(limit_gib: float | None) -> None:
    """Hold this process to some GiB of memory of its own; `None` lifts the limit.

    What is asked for beyond it is refused by the kernel, which Python sees as a `MemoryError`.
    Memory counts once it could be written to, whether or not it is. Raises `UserError` where the
    process takes more already.
    """
    if sys.platform != "linux":
        return
    import resource

    soft, hard = _limits_before()
    soft = soft if limit_gib is None else int(limit_gib * _GIB)
    taken = next(
        int(line.split()[1]) * 1024
        for line in Path("/proc/self/status").read_text().splitlines()
        if line.startswith("VmData")
    )
    if limit_gib is not None and taken >= soft:
        raise UserError(
            f"the system takes {taken / _GIB:.2f} GiB before it flies, and the memory limit is "
            f"{limit_gib:g} GiB: allow more with --memory-limit"
        )
    resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


@cache
def _limits_before() -> tuple[int, int]:
    import resource

    return resource.getrlimit(resource.RLIMIT_DATA)


class NothingRuns(UserError):
    """A system failed in all of the first trials: the rest would only repeat it."""
