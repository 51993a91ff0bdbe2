"""When a statement is confirmed, when it is refuted, and when the run leaves it open.

`docs/design/claims.md` gives the reasons. No rule knows the figure that the paper reports.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from faultpath.record import Answer
from faultpath.statistics import Contrast
from faultpath.statistics.contrast import ROUNDING

POINT_SCENES = 50
"""From so many scenes on an estimate decides where the paper's own does: half of the paper's
hundred. A rate of success then has a standard error of at most 7 pp."""


class Judged(NamedTuple):
    """An answer, and why where the numbers do not say it."""

    answer: Answer
    reason: str = ""


CONFIRMED, REFUTED = Judged("confirmed"), Judged("refuted")
FEW_SCENES = Judged("undecided", "too few scenes")
FEW_FOR_POINTS = Judged("undecided", f"an estimate alone decides from {POINT_SCENES} scenes on")
TIED = Judged("undecided", "the estimate is a tie")


class Rule(Protocol):
    """One way of deciding."""

    def words(self, subject: str) -> str:
        """Return the statement about `subject`."""
        ...

    def judge(self, found: Contrast) -> Judged:
        """Answer it."""
        ...


def by_point(n_scenes: int) -> bool:
    """Return whether there are scenes enough for an estimate to decide without its interval."""
    return n_scenes >= POINT_SCENES


Ends = tuple[float, float]


def telling(interval: Ends | None, n_scenes: int) -> Ends | None:
    """Return the interval to set a threshold beside: `None` where it says no more than a point.

    Scenes that are all alike give an interval without width, which of few scenes is a point
    estimate by another name.
    """
    if interval is None or by_point(n_scenes):
        return interval
    return interval if interval[1] - interval[0] > ROUNDING else None


@dataclass(frozen=True)
class Detected:
    """The difference lies on one side of 0: interval and test agree."""

    sign: int

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} is {_side(self.sign)} 0"

    def judge(self, found: Contrast) -> Judged:
        """Confirm on this side, refute on the other one."""
        if found.detected:
            return CONFIRMED if found.detected == self.sign else REFUTED
        if found.interval is None:
            return FEW_SCENES
        if found.side:
            return Judged("undecided", "the interval excludes 0, the test does not reject")
        return Judged("undecided")


@dataclass(frozen=True)
class NotDetected:
    """No difference is detected, on one side of 0 or on either."""

    sign: int | None = None

    def words(self, subject: str) -> str:
        """Return the statement."""
        where = "to differ from" if self.sign is None else _side(self.sign)
        return f"{subject} is not detected {where} 0"

    def judge(self, found: Contrast) -> Judged:
        """Refute a rejection there; confirm its absence where it would have been seen."""
        if found.interval is None:
            return FEW_SCENES
        if found.rejected:
            return REFUTED if self.sign in (None, found.rejected) else CONFIRMED
        if found.least is None:
            return Judged("undecided", "no difference, however large, is sure to be detected")
        if found.notable is not None and found.least > found.notable:
            return Judged("undecided", "a difference of notable size could have been missed")
        return CONFIRMED


@dataclass(frozen=True)
class Bound:
    """The value reaches a threshold from above or from below."""

    limit: float
    sign: int
    """1: at least; -1: at most."""
    strict: bool = False
    detected: bool = False
    """Whether it has to be detected on the side of the limit too."""

    def words(self, subject: str) -> str:
        """Return the statement."""
        loose = {1: "at least", -1: "at most"}[self.sign]
        text = {1: "above", -1: "below"}[self.sign] if self.strict else loose
        return f"{subject} is {text} {self.limit:g}{' and detected' if self.detected else ''}"

    def judge(self, found: Contrast) -> Judged:
        """Refute when the whole interval misses; confirm when it meets, or the estimate may do so.

        The estimate may in a run that is large enough, unless the limit is 0: on which side of 0 a
        difference lies only an interval that leaves 0 out can say.
        """
        met = self.met(found.value, found.interval, found.n_scenes)
        if met is CONFIRMED and self.detected and found.detected != self.sign:
            return Judged("undecided", "met, but not detected")
        return met

    def met(self, value: float, interval: Ends | None, n_scenes: int) -> Judged:
        """Answer by a value and its interval alone."""
        interval = telling(interval, n_scenes)
        if interval is None:
            return FEW_SCENES
        near, far = interval if self.sign > 0 else interval[::-1]
        if self._ahead(far) < 0:
            return REFUTED
        if not self._meets(value):
            return Judged("undecided")
        if self._ahead(near) <= 0:
            if self.limit == 0:
                return Judged("undecided", "met by the estimate, but the interval reaches 0")
            if not by_point(n_scenes):
                return FEW_FOR_POINTS
        return CONFIRMED

    def _meets(self, value: float) -> bool:
        ahead = self._ahead(value)
        return ahead > 0 if self.strict else ahead >= 0

    def _ahead(self, value: float) -> float:
        return self.sign * (value - self.limit)


@dataclass(frozen=True)
class Within:
    """The value lies between two limits, or on them."""

    low: float
    high: float

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} lies between {self.low:g} and {self.high:g}"

    def judge(self, found: Contrast) -> Judged:
        """Refute when the whole interval misses; confirm when all of it lies inside.

        In a run that is large enough the estimate may lie there alone.
        """
        interval = telling(found.interval, found.n_scenes)
        if interval is None:
            return FEW_SCENES
        low, high = interval
        if high < self.low or low > self.high:
            return REFUTED
        if not self.low <= found.value <= self.high:
            return Judged("undecided")
        inside = self.low < low and high < self.high
        return CONFIRMED if inside or by_point(found.n_scenes) else FEW_FOR_POINTS


@dataclass(frozen=True)
class ByPoint:
    """A claim about point estimates: the value lies on one side of a limit."""

    sign: int
    limit: float = 0.0
    strict: bool = True

    def words(self, subject: str) -> str:
        """Return the statement."""
        text = _side(self.sign) if self.strict else {1: "at least", -1: "at most"}[self.sign]
        return f"{subject} is {text} {self.limit:g}, by the point estimate"

    def judge(self, found: Contrast) -> Judged:
        """Decide by the value alone, in a run that is large enough; a tie confirms no advantage."""
        if not found.enough:
            return FEW_SCENES
        if not by_point(found.n_scenes):
            return FEW_FOR_POINTS
        ahead = self.sign * (found.value - self.limit)
        if ahead == 0:
            return TIED if self.strict else CONFIRMED
        return CONFIRMED if ahead > 0 else REFUTED


@dataclass(frozen=True)
class Reported:
    """A quantity that the claim wants stated, whatever it is."""

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"reported: {subject}"

    def judge(self, found: Contrast) -> Judged:
        """Confirm that it is there: what is not raises `NotRun` before."""
        return CONFIRMED


ABOVE, BELOW = Detected(1), Detected(-1)
NO_GAIN, NO_LOSS = NotDetected(1), NotDetected(-1)
REPORTED = Reported()


def at_least(limit: float, *, detected: bool = False) -> Bound:
    """Return the rule of a lower limit."""
    return Bound(limit, 1, detected=detected)


def more_than(limit: float) -> Bound:
    """Return the rule of a lower limit that is not reached by equality."""
    return Bound(limit, 1, strict=True)


def less_than(limit: float) -> Bound:
    """Return the rule of an upper limit that is not reached by equality."""
    return Bound(limit, -1, strict=True)


def _side(sign: int) -> str:
    return "above" if sign > 0 else "below"
