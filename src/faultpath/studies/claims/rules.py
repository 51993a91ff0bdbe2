"""When a statement is confirmed, when it is refuted, and when the run leaves it open.

`docs/design/claims.md` gives the reasons. No rule knows the figure that the paper reports.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeVar

from faultpath.record import Answer
from faultpath.studies.claims.found import Found


class Judged(NamedTuple):
    """An answer, and why where the numbers do not say it."""

    answer: Answer
    reason: str = ""


CONFIRMED, REFUTED = Judged("confirmed"), Judged("refuted")
FEW_SCENES = Judged("undecided", "too few scenes")


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
        """Confirm by the estimate, refute when the whole interval misses."""
        if found.value is None or found.interval is None:
            return FEW_SCENES
        low, high = found.interval
        if self._meets(found.value):
            unseen = self.detected and found.detected != self.sign
            return Judged("undecided", "met, but not detected") if unseen else CONFIRMED
        return Judged("undecided") if self._meets(high if self.sign > 0 else low) else REFUTED

    def _meets(self, value: float) -> bool:
        ahead = self.sign * (value - self.limit)
        return ahead > 0 if self.strict else ahead >= 0


@dataclass(frozen=True)
class Within:
    """The value lies between two limits, or on them."""

    low: float
    high: float

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} lies between {self.low:g} and {self.high:g}"

    def judge(self, found: Found) -> Judged:
        """Confirm by the estimate, refute when the whole interval misses."""
        if found.value is None or found.interval is None:
            return FEW_SCENES
        if self.low <= found.value <= self.high:
            return CONFIRMED
        low, high = found.interval
        return REFUTED if high < self.low or low > self.high else Judged("undecided")


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
        """Decide by the value alone."""
        if found.value is None or not found.enough:
            return FEW_SCENES
        ahead = self.sign * (found.value - self.limit)
        return CONFIRMED if ahead > 0 or (ahead == 0 and not self.strict) else REFUTED


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
