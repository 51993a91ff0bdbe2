"""`scipy.stats.bootstrap`, vectorised, on each scene's difference: the percentile interval.

Resampling scenes with all their seeds is resampling the scenes' means.
"""

import numpy as np
from scipy.stats import bootstrap

from benchmarks.physics import RESAMPLES, interval, outcomes
from benchmarks.side import Side, check_same


def percentile() -> Side:
    one, two = outcomes()
    difference = 100.0 * (one.astype(float) - two.astype(float)).mean(1)

    def peer() -> tuple[float, float]:
        result = bootstrap(
            (difference,),
            np.mean,
            n_resamples=RESAMPLES,
            method="percentile",
            rng=np.random.default_rng(0),
        )
        return result.confidence_interval.low, result.confidence_interval.high

    check_same(peer(), interval(), 1.0)
    return Side(peer)
