"""How long a block may take, and how many failures say that nothing works."""

import math

from faultpath.errors import UserError
from faultpath.patience import building_s

FIRST_S = 3600.0
"""Until a first block is done nobody knows how long one takes."""
LEAST_S = 300.0
TIMES = 20
FEW = 5
"""So many failed trials without one that ran to its end stop the study."""


class TimeLimit:
    """The seconds that a task may take: as asked, or many times as long as the slowest so far."""

    def __init__(self, asked_s: float | None = None) -> None:
        if asked_s is not None and not (math.isfinite(asked_s) and asked_s > 0):
            raise UserError(f"the time limit is {asked_s:g} s: give a number of seconds above 0")
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


class NothingRuns(UserError):
    """A system failed in all of the first trials: the rest would only repeat it."""
