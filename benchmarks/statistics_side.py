"""A paired bootstrap of 100 scenes and 3 seeds with 10,000 resamples, ours and SciPy's."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import bootstrap
from typing_extensions import override

from benchmarks.side import Side
from faultpath.statistics import Resamples, success_effect
from faultpath.streams import generator

SCENES, SEEDS, RESAMPLES = 100, 3, 10_000


def outcomes() -> tuple[np.ndarray, np.ndarray]:
    """Return successes of two arms, `[100, 3]`."""
    draws = generator("benchmark-outcomes", "all", 0)
    return draws.random((SCENES, SEEDS)) < 0.6, draws.random((SCENES, SEEDS)) < 0.7


class Ours(Side):
    """Effect and interval; with `drawn`, on resamples that are there already."""

    def __init__(self, drawn: bool = False) -> None:
        self._arms = outcomes()
        self._kept = self._draw() if drawn else None

    @override
    def work(self) -> None:
        self._estimate()

    def answer(self) -> Sequence[float]:
        """Return the ends of the interval, percentage points."""
        return self._estimate()

    def _draw(self) -> Resamples:
        return Resamples.draw("benchmark", SCENES, n_resamples=RESAMPLES)

    def _estimate(self) -> tuple[float, float]:
        resamples = self._kept or self._draw()
        found = success_effect(*self._arms, resamples).estimate()
        assert found.low is not None
        assert found.high is not None
        return found.low, found.high


class Scipy(Side):
    """`scipy.stats.bootstrap`, vectorised, on each scene's difference: the percentile interval.

    Resampling scenes with all their seeds is resampling the scenes' means.
    """

    def __init__(self) -> None:
        one, two = outcomes()
        self._difference = 100.0 * (one.astype(float) - two.astype(float)).mean(1)

    @override
    def work(self) -> None:
        self._interval()

    def answer(self) -> Sequence[float]:
        """Return the ends of the interval, percentage points."""
        return self._interval()

    def _interval(self) -> tuple[float, float]:
        found = bootstrap(
            (self._difference,), np.mean, n_resamples=RESAMPLES, method="percentile",
            vectorized=True, rng=np.random.default_rng(0),
        )  # fmt: skip
        return found.confidence_interval.low, found.confidence_interval.high
