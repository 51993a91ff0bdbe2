"""Outcome arrays in, estimates and intervals out; no plots and no files."""

from faultpath.statistics.breakeven import break_even
from faultpath.statistics.effects import success_effect
from faultpath.statistics.estimate import BreakEven, Estimate
from faultpath.statistics.resamples import Resamples

__all__ = ["BreakEven", "Estimate", "Resamples", "break_even", "success_effect"]
