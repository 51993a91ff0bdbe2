"""What a run shows of a statement: a number, its interval, and the paper's test where one is."""

from collections.abc import Callable
from dataclasses import dataclass

from faultpath.statistics import Contrast, fewest_scenes
from faultpath.statistics.estimate import PairedTest
from faultpath.studies.results import Results

MIN_SCENES = fewest_scenes(1)
"""With fewer, nothing is called a detection: even if all agree no test rejects at 0.05."""
ROUNDING = 1e-12
"""Draws that spread no more than this are all the same."""

POINT_SCENES = 50
"""From so many scenes on an estimate decides where the paper's own does: half of the paper's
hundred. A rate of success then has a standard error of at most 7 pp."""


class Undecidable(Exception):
    """The run holds everything that was asked for, and yet nothing that decides."""


@dataclass(frozen=True)
class Found:
    """A quantity of the run; rules say what it makes of a statement."""

    value: float | None
    interval: tuple[float, float] | None
    """Ends of the 95 % interval; `None` where none is known or too few scenes give it."""
    unit: str
    n_scenes: int
    test: PairedTest | None = None
    """The paper's test, for outcomes that are yes or no."""
    mde: float | None = None
    """Least difference from 0 that would have been detected, in `unit`."""
    telling_mde: float | None = None
    """With a greater `mde` than this, not detecting a difference says nothing."""
    counts: str = ""

    @property
    def enough(self) -> bool:
        """Whether there are scenes enough to decide anything."""
        return self.n_scenes >= MIN_SCENES

    @property
    def speaks_by_estimate(self) -> bool:
        """Whether there are scenes enough for an estimate to decide without its interval."""
        return self.n_scenes >= POINT_SCENES

    @property
    def range(self) -> tuple[float, float] | None:
        """The interval to set a threshold beside: `None` where it says no more than the estimate.

        Scenes that are all alike give an interval without width, which of few scenes is a point
        estimate by another name.
        """
        if self.interval is None or self.speaks_by_estimate:
            return self.interval
        low, high = self.interval
        return self.interval if high - low > ROUNDING else None

    @property
    def side(self) -> int:
        """Side of 0 on which the whole interval lies; 0 when it touches 0, or without one."""
        if self.interval is None:
            return 0
        low, high = self.interval
        return 1 if low > 0 else -1 if high < 0 else 0

    @property
    def detected(self) -> int:
        """Side of 0 on which interval and test agree; the interval decides where no test is."""
        return self.side if self.test is None or self.rejected == self.side else 0

    @property
    def rejected(self) -> int:
        """Side that the test finds ahead; without a test, the side of the interval."""
        if self.test is None:
            return self.side
        return self.test.leans if self.test.rejects() else 0


Quantity = Callable[[Results], Found]
"""Works a quantity out; raises `NotRun` or `Undecidable`."""


def of_effect(effect: Contrast, telling_mde: float | None = None) -> Found:
    """Return an effect without a test: its interval decides, and gives the standard error."""
    return Found(
        value=effect.value,
        interval=effect.interval if effect.enough else None,
        unit=effect.unit,
        n_scenes=effect.n_scenes,
        mde=effect.least,
        telling_mde=telling_mde,
    )
