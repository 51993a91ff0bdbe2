"""Estimates, intervals and tests from arrays of outcomes; no plots and no files."""

from faultpath.stats.breakeven import break_even
from faultpath.stats.effects import success_effect
from faultpath.stats.estimate import BreakEven, Estimate
from faultpath.stats.resamples import Resamples

__all__ = ["BreakEven", "Estimate", "Resamples", "break_even", "success_effect"]
