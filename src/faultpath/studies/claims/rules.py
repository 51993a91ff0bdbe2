"""When a statement is confirmed, when it is refuted, and when the run leaves it open.

`docs/design/claims.md` gives the reasons. No rule knows the figure that the paper reports.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeVar

from faultpath.record import Answer
from faultpath.studies.quantities.found import POINT_SCENES, Found


class Judged(NamedTuple):
    """An answer, and why where the numbers do not say it."""

    answer: Answer
    reason: str = ""


CONFIRMED, REFUTED = Judged("confirmed"), Judged("refuted")
FEW_SCENES = Judged("undecided", "too few scenes")
FEW_FOR_POINTS = Judged("undecided", f"an estimate alone decides from {POINT_SCENES} scenes on")
TIED = Judged("undecided", "the estimate is a tie")

F = TypeVar("F", bound=Found, contravariant=True)


class Rule(Protocol[F]):
    """One way of deciding; some need more than `Found` has."""

    def words(self, subject: str) -> str:
        """Return the statement about `subject`."""
        ...

    def judge(self, found: F) -> Judged:
        """Answer it."""
        ...


@dataclass(frozen=True)
class Detected:
    """The difference lies on one side of 0: interval and test agree."""

    sign: int

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} is {_side(self.sign)} 0"

    def judge(self, found: Found) -> Judged:
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

    def judge(self, found: Found) -> Judged:
        """Refute a rejection there; confirm its absence where it would have been seen."""
        if found.interval is None:
            return FEW_SCENES
        if found.rejected:
            return REFUTED if self.sign in (None, found.rejected) else CONFIRMED
        if found.mde is None:
            return Judged("undecided", "no difference, however large, is sure to be detected")
        if found.telling_mde is not None and found.mde > found.telling_mde:
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

    def judge(self, found: Found) -> Judged:
        """Refute when the whole interval misses; confirm when it meets, or the estimate may do so.

        The estimate may in a run that is large enough, unless the limit is 0: on which side of 0 a
        difference lies only an interval that leaves 0 out can say.
        """
        if found.value is None or found.range is None:
            return FEW_SCENES
        low, high = found.range
        near, far = (low, high) if self.sign > 0 else (high, low)
        if self._ahead(far) < 0:
            return REFUTED
        if not self._meets(found.value):
            return Judged("undecided")
        if self._ahead(near) <= 0:
            if self.limit == 0:
                return Judged("undecided", "met by the estimate, but the interval reaches 0")
            if not found.speaks_by_estimate:
                return FEW_FOR_POINTS
        unseen = self.detected and found.detected != self.sign
        return Judged("undecided", "met, but not detected") if unseen else CONFIRMED

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

    def judge(self, found: Found) -> Judged:
        """Refute when the whole interval misses; confirm when all of it lies inside.

        In a run that is large enough the estimate may lie there alone.
        """
        if found.value is None or found.range is None:
            return FEW_SCENES
        low, high = found.range
        if high < self.low or low > self.high:
            return REFUTED
        if not self.low <= found.value <= self.high:
            return Judged("undecided")
        inside = self.low < low and high < self.high
        return CONFIRMED if inside or found.speaks_by_estimate else FEW_FOR_POINTS


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

    def judge(self, found: Found) -> Judged:
        """Decide by the value alone, in a run that is large enough; a tie confirms no advantage."""
        if found.value is None or not found.enough:
            return FEW_SCENES
        if not found.speaks_by_estimate:
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

    def judge(self, found: Found) -> Judged:
        """Confirm that it is there."""
        return Judged("undecided", "no value") if found.value is None else CONFIRMED


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
