"""When a statement is confirmed, when it is refuted, and when the run leaves it open.

`docs/design/claims.md` gives the reasons. A statement's last words name its rule. A rule judges
contrasts with the interval of the paper, the percentile bootstrap of scenes, and does not know the
figure that the paper reports.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
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


class Rule(NamedTuple):
    """One way of deciding."""

    judge: Callable[[Contrast], Judged]
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


def _detected(side: str) -> Rule:
    """The difference is detected on one side of 0; refuted on the other."""

    def judge(contrast: Contrast) -> Judged:
        if found := detection(contrast):
            return CONFIRMED if found == _SIDES[side] else REFUTED
        if contrast.interval is None:
            return FEW_SCENES
        if contrast.sign_of_interval:
            return Judged("undecided", "the interval excludes 0, the test does not reject")
        return OPEN

    return Rule(judge)


def _not_detected(side: str) -> Rule:
    """No difference is detected, on one side of 0 or on either.

    Refuted where interval and test find one there; else confirmed where it would have been seen.
    """

    def judge(contrast: Contrast) -> Judged:
        if contrast.interval is None:
            return FEW_SCENES
        if found := significant_side(contrast):
            return REFUTED if found == _SIDES.get(side, found) else CONFIRMED
        least = least_detectable(contrast)
        if least is None:
            return Judged("undecided", "no difference, however large, is sure to be significant")
        if isinstance(contrast, Difference) and least > contrast.telling:
            return Judged("undecided", "a difference of a size that counts could have been missed")
        return CONFIRMED

    return Rule(judge, sided=False)


@dataclass(frozen=True)
class Range:
    """Values that a statement names, on one side of a limit or between two."""

    low: float = -inf
    high: float = inf
    strict: bool = False
    """Whether a value equal to a limit misses it."""

    @classmethod
    def of(cls, side: str, limit: str) -> "Range":
        """Return the range of words such as `above` and `15`."""
        strict = side in ("above", "below")
        if _SIDES[side] > 0:
            return cls(low=float(limit), strict=strict)
        return cls(high=float(limit), strict=strict)

    def holds(self, value: float) -> bool:
        """Return whether a value lies in the range."""
        if self.strict:
            return self.low < value < self.high
        return self.low <= value <= self.high

    def judge(self, value: float, interval: Ends | None, n_scenes: int) -> Judged:
        """Refute when the whole interval misses; confirm when all of it lies inside.

        In a large enough run the estimate alone may confirm.
        """
        interval = telling(interval, n_scenes)
        if interval is None:
            return FEW_SCENES
        low, high = interval
        if high < self.low or low > self.high:
            return REFUTED
        if not self.holds(value):
            return OPEN
        inside = self.low < low and high < self.high
        return CONFIRMED if inside or points_decide(n_scenes) else FEW_FOR_POINTS


def _bounded(side: str, limit: str, seen: str | None) -> Rule:
    """The value meets a bound; `seen`: and is detected on that side of 0."""
    bound = Range.of(side, limit)

    def judge(contrast: Contrast) -> Judged:
        met = bound.judge(contrast.value, contrast.interval, contrast.n_scenes)
        if met == CONFIRMED and seen and detection(contrast) != _SIDES[side]:
            return Judged("undecided", "met, but not significant")
        return met

    return Rule(judge)


def _within(least: str, most: str) -> Rule:
    """The value lies between two limits, or on them."""
    limits = Range(float(least), float(most))

    def judge(contrast: Contrast) -> Judged:
        return limits.judge(contrast.value, contrast.interval, contrast.n_scenes)

    return Rule(judge, sided=False)


def _by_point(side: str, limit: str) -> Rule:
    """The point estimate, in a large enough run, is on one side of a limit.

    A tie confirms no advantage.
    """
    bound = Range.of(side, limit)

    def judge(contrast: Contrast) -> Judged:
        if not enough(contrast):
            return FEW_SCENES
        if not points_decide(contrast.n_scenes):
            return FEW_FOR_POINTS
        if bound.holds(contrast.value):
            return CONFIRMED
        return TIED if contrast.value == float(limit) else REFUTED

    return Rule(judge)


def _reported() -> Rule:
    """Results that are there: a quantity that was not run raises `NotRun`."""

    def judge(contrast: Contrast) -> Judged:
        return CONFIRMED

    return Rule(judge)


_SIDES = {"above": 1, "at least": 1, "below": -1, "at most": -1}
BOUND = r".* is (above|below|at least|at most) (-?[\d.]+)"
"""Words that end in a bound."""
_RULES: dict[str, Callable[..., Rule]] = {
    r"reported: .*": _reported,
    r".* is significantly (above|below) 0": _detected,
    r".* is not significantly (above|below|different from) 0": _not_detected,
    r".* lies between (\S+) and (\S+)": _within,
    rf"{BOUND}, by the point estimate": _by_point,
    rf"{BOUND}( and significant)?": _bounded,
}


def rule_of(words: str) -> Rule:
    """Return the rule that a statement's last words name; `ValueError` where they name none."""
    for pattern, rule in _RULES.items():
        if named := re.fullmatch(pattern, words):
            return rule(*named.groups())
    raise ValueError(f"no rule ends in the words of '{words}'")
