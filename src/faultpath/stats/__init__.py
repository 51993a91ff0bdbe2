"""Estimates, intervals and tests from arrays of outcomes; no plots and no files.

`effects` makes a `Contrast` of two variants' outcomes, `contrast` gives its interval and combines
effects, and `decisions` tests and corrects them. The tests are in `score`, `unconditional` and
`betting`; what follows from effects is in `power` and `breakeven`; `cancelling` serves scans.
"""

from faultpath.stats.breakeven import break_even
from faultpath.stats.effects import success_effect
from faultpath.stats.estimate import BreakEven, Estimate
from faultpath.stats.resamples import Resamples

__all__ = ["BreakEven", "Estimate", "Resamples", "break_even", "success_effect"]
