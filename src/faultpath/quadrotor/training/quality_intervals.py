"""Statistics of validation windows with intervals that resample whole episodes.

Windows of an episode share a vehicle, a flight and its wind, so they are not independent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.quadrotor.training.quality_results import Interval
from faultpath.statistics import Resamples, percentile_interval

RESAMPLES = 2000

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Drawn:
    """A statistic, and its value in each resample, `[R]`."""

    value: float
    draws: Floats

    @classmethod
    def mean(cls, parts: Sequence[Drawn]) -> Drawn:
        """Return the mean of statistics of the same resamples."""
        return cls(
            float(np.mean([part.value for part in parts])),
            np.mean([part.draws for part in parts], axis=0),
        )

    def interval(self) -> Interval:
        """Return it with its percentile interval of 95 %."""
        low, high = percentile_interval(self.draws, 0.95)
        return Interval(value=self.value, low=low, high=high)


class Episodes:
    """Resamples of the episodes that W windows belong to; all models of a pool share them."""

    def __init__(self, pool: str, episode: NDArray[np.int64]) -> None:
        found, place = np.unique(episode, return_inverse=True)
        resamples = Resamples.draw(f"validation/{pool}", len(found), n_resamples=RESAMPLES)
        self.count = len(found)
        self._weights = resamples.counts[:, place]  # [R, W]

    def median(self, values: Floats) -> Drawn:
        """Return the median over windows of `values` `[W]`."""
        order = np.argsort(values, kind="stable")
        ordered = values[order]
        reached = np.cumsum(self._weights[:, order], axis=1)
        total = reached[:, -1:]
        # The middle one, or the two middle ones, of the resampled values in ascending order.
        lower = (reached < np.ceil(total / 2)).sum(axis=1)
        upper = (reached < np.floor(total / 2) + 1).sum(axis=1)
        return Drawn(float(np.median(values)), (ordered[lower] + ordered[upper]) / 2)

    def root_mean_square(self, squared: Floats) -> Drawn:
        """Return the root of the mean over windows of `squared` `[W]`."""
        means = self._weights @ squared / self._weights.sum(axis=1)
        return Drawn(float(np.sqrt(squared.mean())), np.sqrt(means))
