"""Outcome arrays in, estimates and intervals out; no plots and no files."""

from faultpath.statistics.bootstrap import mean_effect, success_effect, success_rate
from faultpath.statistics.breakeven import break_even, break_even_point, mixture_curve
from faultpath.statistics.clustered import (
    WindowQuantiles,
)
from faultpath.statistics.correlation import spearman
from faultpath.statistics.decisions import (
    Comparison,
    Decision,
    compare,
    decide_family,
    fewest_scenes,
    turn,
)
from faultpath.statistics.detectable import detectable
from faultpath.statistics.effect import (
    Effect,
    difference_of_effects,
    percentile_interval,
    weighted_sum,
)
from faultpath.statistics.estimate import (
    SCENES,
    SCENES_AND_SEEDS,
    BreakEven,
    Correlation,
    Detectable,
    Discordant,
    Estimate,
    Region,
    SeedCounts,
    TestResult,
)
from faultpath.statistics.medians import median_effect
from faultpath.statistics.paired import (
    discordant,
    discordant_by_seed,
    mcnemar_exact,
    mcnemar_mid_p,
    sign_counts,
    sign_test,
    success_test,
)
from faultpath.statistics.power import rule_power
from faultpath.statistics.resamples import Resamples

__all__ = [
    "SCENES",
    "SCENES_AND_SEEDS",
    "BreakEven",
    "Comparison",
    "Correlation",
    "Decision",
    "Detectable",
    "Discordant",
    "Effect",
    "Estimate",
    "Region",
    "Resamples",
    "SeedCounts",
    "TestResult",
    "WindowQuantiles",
    "break_even",
    "break_even_point",
    "compare",
    "decide_family",
    "detectable",
    "difference_of_effects",
    "discordant",
    "discordant_by_seed",
    "fewest_scenes",
    "mcnemar_exact",
    "mcnemar_mid_p",
    "mean_effect",
    "median_effect",
    "mixture_curve",
    "percentile_interval",
    "rule_power",
    "sign_counts",
    "sign_test",
    "spearman",
    "success_effect",
    "success_rate",
    "success_test",
    "turn",
    "weighted_sum",
]
