"""A paired bootstrap of 100 scenes and 3 seeds with 10,000 resamples, ours and SciPy's."""

import numpy as np
from scipy.stats import bootstrap

from benchmarks.measure import Side
from faultpath.statistics import Resamples, success_effect
from faultpath.streams import generator

SCENES, SEEDS, RESAMPLES = 100, 3, 10_000


def outcomes() -> tuple[np.ndarray, np.ndarray]:
    """Return successes of two arms, `[100, 3]`."""
    draws = generator("benchmark-outcomes", "all", 0)
    return draws.random((SCENES, SEEDS)) < 0.6, draws.random((SCENES, SEEDS)) < 0.7


def ours(drawn: bool = False) -> Side:
    """Effect and interval; with `drawn`, on resamples that are there already."""
    arms = outcomes()

    def draw() -> Resamples:
        return Resamples.draw("benchmark", SCENES, n_resamples=RESAMPLES)

    kept = draw() if drawn else None

    def interval() -> tuple[float, float]:
        """Return the ends of the interval, percentage points."""
        found = success_effect(*arms, kept or draw()).estimate()
        assert found.low is not None
        assert found.high is not None
        return found.low, found.high

    return Side(interval, answer=interval)


def scipy() -> Side:
    """`scipy.stats.bootstrap`, vectorised, on each scene's difference: the percentile interval.

    Resampling scenes with all their seeds is resampling the scenes' means.
    """
    one, two = outcomes()
    difference = 100.0 * (one.astype(float) - two.astype(float)).mean(1)

    def interval() -> tuple[float, float]:
        """Return the ends of the interval, percentage points."""
        found = bootstrap(
            (difference,), np.mean, n_resamples=RESAMPLES, method="percentile",
            vectorized=True, rng=np.random.default_rng(0),
        )  # fmt: skip
        return found.confidence_interval.low, found.confidence_interval.high

    return Side(interval, answer=interval)
