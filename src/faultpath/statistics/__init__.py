"""Outcome arrays in, estimates and intervals out; no plots and no files."""

from faultpath.statistics.bootstrap import (
    Effect,
    difference_of_effects,
    mean_effect,
    mean_value,
    percentile_interval,
    reversal,
    success_effect,
    success_rate,
)
from faultpath.statistics.breakeven import break_even, break_even_point
from faultpath.statistics.clustered import (
    WindowQuantiles,
    quantile_difference,
    quantile_estimate,
    quantile_log_ratio,
    quantile_ratio,
)
from faultpath.statistics.correlation import spearman
from faultpath.statistics.estimate import (
    SCENES,
    SCENES_AND_SEEDS,
    BreakEven,
    Correlation,
    Detectable,
    Direction,
    DirectionShares,
    Discordant,
    Estimate,
    Reversal,
    SeedCounts,
    TestResult,
)
from faultpath.statistics.inputs import against_each_seed
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
from faultpath.statistics.power import (
    detectable,
    detectable_by_sign_test,
    detectable_by_standard_error,
    detectable_success,
    mcnemar_power,
)
from faultpath.statistics.resamples import Resamples

__all__ = [
    "SCENES",
    "SCENES_AND_SEEDS",
    "BreakEven",
    "Correlation",
    "Detectable",
    "Direction",
    "DirectionShares",
    "Discordant",
    "Effect",
    "Estimate",
    "Resamples",
    "Reversal",
    "SeedCounts",
    "TestResult",
    "WindowQuantiles",
    "against_each_seed",
    "break_even",
    "break_even_point",
    "detectable",
    "detectable_by_sign_test",
    "detectable_by_standard_error",
    "detectable_success",
    "difference_of_effects",
    "discordant",
    "discordant_by_seed",
    "mcnemar_exact",
    "mcnemar_mid_p",
    "mcnemar_power",
    "mean_effect",
    "mean_value",
    "median_effect",
    "percentile_interval",
    "quantile_difference",
    "quantile_estimate",
    "quantile_log_ratio",
    "quantile_ratio",
    "reversal",
    "sign_counts",
    "sign_test",
    "spearman",
    "success_effect",
    "success_rate",
    "success_test",
]
