"""When a statement is confirmed, when it is refuted, and when the run leaves it open.

`docs/design/claims.md` gives the reasons. A rule judges contrasts with the interval of the paper,
the percentile bootstrap of scenes, and does not know the figure that the paper reports.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from faultpath.stats.contrast import Contrast
from faultpath.stats.resamples import ROUNDING
from faultpath_paper.answers import Answer
from faultpath_paper.detection import (
    Difference,
    detection,
    enough,
    least_detectable,
    significant_side,
)

POINT_SCENES = 50
"""Scenes from which on an estimate decides where the paper's own does: half of the paper's
hundred. A rate of success then has a standard error of at most 7 pp."""

Ends = tuple[float, float]


class Judged(NamedTuple):
    """An answer, and why where the numbers do not say it."""

    answer: Answer
    reason: str = ""


CONFIRMED, REFUTED, OPEN = Judged("confirmed"), Judged("refuted"), Judged("undecided")
FEW_SCENES = Judged("undecided", "too few scenes")
FEW_FOR_POINTS = Judged("undecided", f"an estimate alone counts from {POINT_SCENES} scenes on")
TIED = Judged("undecided", "the estimate is a tie")


@dataclass(frozen=True)
class Rule:
    """One way of deciding."""

    words: str
    """The statement, with `{}` for its subject."""
    judge: Callable[[Contrast], Judged]
    """Judges a contrast."""
    sided: bool = True
    """Whether the statement is about a side of no effect, rather than about there being none."""


def points_decide(n_scenes: int) -> bool:
    """Return whether there are enough scenes for an estimate to decide without its interval."""
    return n_scenes >= POINT_SCENES


def telling(interval: Ends | None, n_scenes: int) -> Ends | None:
    """Return the interval to compare with a threshold; `None` where it says no more than a point.

    Scenes that are all alike give an interval of no width, which for few scenes is only a point
    estimate.
    """
    if interval is None or points_decide(n_scenes):
        return interval
    return interval if interval[1] - interval[0] > ROUNDING else None


def detected(sign: int) -> Rule:
    """Return the rule that the difference is detected on one side of 0; refuted on the other."""

    def judge(contrast: Contrast) -> Judged:
        side = detection(contrast)
        if side:
            return CONFIRMED if side == sign else REFUTED
        if contrast.interval is None:
            return FEW_SCENES
        if contrast.sign_of_interval:
            return Judged("undecided", "the interval excludes 0, the test does not reject")
        return OPEN

    return Rule(f"{{}} is significantly {_SIDES[sign]} 0", judge)


def not_detected(sign: int | None = None) -> Rule:
    """Return the rule that no difference is detected, on one side of 0 or on either.

    Refuted where interval and test find one there; else confirmed where it would have been seen.
    """

    def judge(contrast: Contrast) -> Judged:
        if contrast.interval is None:
            return FEW_SCENES
        if side := significant_side(contrast):
            return REFUTED if sign in (None, side) else CONFIRMED
        least = least_detectable(contrast)
        if least is None:
            return Judged("undecided", "no difference, however large, is sure to be significant")
        if isinstance(contrast, Difference) and least > contrast.telling:
            return Judged("undecided", "a difference of a size that counts could have been missed")
        return CONFIRMED

    where = "different from" if sign is None else _SIDES[sign]
    return Rule(f"{{}} is not significantly {where} 0", judge, sided=False)


@dataclass(frozen=True)
class Bound:
    """A threshold, reached from above or from below."""

    limit: float
    sign: int
    """1: at least; -1: at most."""
    strict: bool = False
    """Whether a value equal to the limit misses it."""

    @property
    def words(self) -> str:
        """The statement, with `{}` for its subject."""
        return f"{{}} is {(_SIDES if self.strict else _LIMITS)[self.sign]} {self.limit:g}"

    def ahead(self, value: float) -> float:
        """Return by how much a value is beyond the limit."""
        return self.sign * (value - self.limit)

    def meets(self, value: float) -> bool:
        """Return whether a value meets the bound."""
        return self.ahead(value) > 0 if self.strict else self.ahead(value) >= 0

    def judge(self, value: float, interval: Ends | None, n_scenes: int) -> Judged:
        """Refute when the whole interval misses; confirm when all of it meets the bound.

        In a large enough run the estimate alone may confirm.
        """
        interval = telling(interval, n_scenes)
        if interval is None:
            return FEW_SCENES
        near, far = interval if self.sign > 0 else interval[::-1]
        if self.ahead(far) < 0:
            return REFUTED
        if not self.meets(value):
            return OPEN
        if self.ahead(near) <= 0 and not points_decide(n_scenes):
            return FEW_FOR_POINTS
        return CONFIRMED


def bounded(bound: Bound, *, seen: bool = False) -> Rule:
    """Return the rule that the value meets a bound; `seen`: and is detected on that side of 0."""

    def judge(contrast: Contrast) -> Judged:
        met = bound.judge(contrast.value, contrast.interval, contrast.n_scenes)
        if met == CONFIRMED and seen and detection(contrast) != bound.sign:
            return Judged("undecided", "met, but not significant")
        return met

    return Rule(f"{bound.words}{' and significant' if seen else ''}", judge)


def at_least(limit: float) -> Rule:
    """Return the rule that the value is at least a limit."""
    return bounded(Bound(limit, 1))


def at_most(limit: float, *, seen: bool = False) -> Rule:
    """Return the rule that the value is at most a limit; `seen` as in `bounded`."""
    return bounded(Bound(limit, -1), seen=seen)


def less_than(limit: float) -> Rule:
    """Return the rule that the value is below a limit."""
    return bounded(Bound(limit, -1, strict=True))


def within(least: float, most: float) -> Rule:
    """Return the rule that the value lies between two limits, or on them.

    Refuted when the whole interval misses; confirmed when all of it lies inside, or in a run that
    is large enough the estimate alone.
    """

    def judge(contrast: Contrast) -> Judged:
        interval = telling(contrast.interval, contrast.n_scenes)
        if interval is None:
            return FEW_SCENES
        low, high = interval
        if high < least or low > most:
            return REFUTED
        if not least <= contrast.value <= most:
            return OPEN
        inside = least < low and high < most
        return CONFIRMED if inside or points_decide(contrast.n_scenes) else FEW_FOR_POINTS

    return Rule(f"{{}} lies between {least:g} and {most:g}", judge, sided=False)


def by_point(sign: int, limit: float = 0.0, *, strict: bool = True) -> Rule:
    """Return the rule that the point estimate, in a large enough run, is on one side of a limit.

    A tie confirms no advantage.
    """
    bound = Bound(limit, sign, strict)

    def judge(contrast: Contrast) -> Judged:
        if not enough(contrast):
            return FEW_SCENES
        if not points_decide(contrast.n_scenes):
            return FEW_FOR_POINTS
        if bound.meets(contrast.value):
            return CONFIRMED
        return REFUTED if bound.ahead(contrast.value) else TIED

    return Rule(f"{bound.words}, by the point estimate", judge)


_SIDES = {1: "above", -1: "below"}
_LIMITS = {1: "at least", -1: "at most"}
ABOVE, BELOW = detected(1), detected(-1)
NO_GAIN, NO_LOSS, NO_DIFFERENCE = not_detected(1), not_detected(-1), not_detected()
REPORTED = Rule("reported: {}", lambda contrast: CONFIRMED)
"""Rule of a quantity that the claim only asks for; one that was not run raises `NotRun`."""
