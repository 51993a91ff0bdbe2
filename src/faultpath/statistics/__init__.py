"""Outcome arrays in, estimates and intervals out; no plots and no files."""

from faultpath.statistics.breakeven import break_even, mixture_curve, only
from faultpath.statistics.contrast import Contrast, change, weighted_sum
from faultpath.statistics.decisions import Turn, decide_family, turn, with_test
from faultpath.statistics.effects import (
    WindowQuantiles,
    mean_effect,
    median_effect,
    success_effect,
    success_rate,
)
from faultpath.statistics.estimate import (
    IN_FORCE,
    RULES,
    BreakEven,
    Estimate,
    Region,
    RuleName,
    Sign,
)
from faultpath.statistics.power import detectable, fewest_scenes
from faultpath.statistics.resamples import Resamples

__all__ = [
    "IN_FORCE",
    "RULES",
    "BreakEven",
    "Contrast",
    "Estimate",
    "Region",
    "Resamples",
    "RuleName",
    "Sign",
    "Turn",
    "WindowQuantiles",
    "break_even",
    "change",
    "decide_family",
    "detectable",
    "fewest_scenes",
    "mean_effect",
    "median_effect",
    "mixture_curve",
    "only",
    "success_effect",
    "success_rate",
    "turn",
    "weighted_sum",
    "with_test",
]
