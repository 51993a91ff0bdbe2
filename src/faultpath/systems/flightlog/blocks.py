"""Medians over a flight whose errors stay alike for a while: blocks that are long enough for that.

Neighbouring intervals share wind and manoeuvre, so a flight holds fewer independent values than
intervals. A block spans several correlation times, blocks are resampled, and the quantile is that
of Student's t with their number: few blocks do not know their own spread.
"""

from collections.abc import Sequence
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics import Contrast, Estimate, WindowQuantiles
from faultpath.statistics.clustered import N_RESAMPLES
from faultpath.statistics.distributions import t_quantile
from faultpath.systems.flightlog.flight import INTERVAL_S
from faultpath.systems.flightlog.reading import Floats

LEAST_S = 2.0
"""No block is shorter."""
TIMES = 4.0
"""Integrated correlation times that a block spans: what neighbours still share is then little."""
LEAST = 8
"""With fewer blocks nothing is decided, and no interval is given."""
_WINDOW = 5.0
"""Correlation times up to which correlations are summed; what lies beyond is noise (Sokal)."""


class Medians:
    """Medians over the intervals of a flight and their ratios, with intervals by blocks.

    Args:
        stretch: Number of the stretch of each interval, `[N]`, ascending.
        errors: All series `[N]` that are to be compared; the block suits the slowest of them.
        n_resamples: Of the blocks.
    """

    def __init__(
        self, stretch: Floats, errors: Sequence[Floats], n_resamples: int = N_RESAMPLES
    ) -> None:
        # A ratio above its median: logarithms, of which none is infinite.
        logs = [np.log(np.maximum(each, np.finfo(np.float64).tiny)) for each in errors]
        compared = [*logs, *(one - two for one, two in combinations(logs, 2))]
        slowest = max(correlation_time(each, stretch) for each in compared)
        length = max(round(LEAST_S / INTERVAL_S), int(np.ceil(TIMES * slowest)))
        self.block_s = length * INTERVAL_S
        """How long a block is."""
        begins = np.searchsorted(stretch, stretch)
        within = (np.arange(len(stretch)) - begins) // length
        names = [f"{one:g}/{two}" for one, two in zip(stretch, within, strict=True)]
        self.blocks = min(len(set(names)), len(stretch) // length)
        """Whole blocks in all intervals together."""
        self._windows = WindowQuantiles(names, n_resamples=n_resamples)

    @property
    def enough(self) -> bool:
        """Whether there are blocks enough to decide anything."""
        return self.blocks >= LEAST

    def value(self, errors: Floats, unit: str) -> Estimate:
        """Return the median of positive errors `[N]`."""
        found = self._windows.value(errors, 0.5, unit)
        with np.errstate(divide="ignore", invalid="ignore"):
            half = self._half(np.log(found.draws))
        return self._with_ends(found, found.value / np.exp(half), found.value * np.exp(half))

    def log_ratio(self, one: Floats, two: Floats) -> Estimate:
        """Return the logarithm of the ratio of two medians."""
        found = self._windows.log_ratio(one, two, 0.5)
        half = self._half(found.draws)
        return self._with_ends(found, found.value - half, found.value + half)

    def _half(self, draws: Floats) -> float:
        """Return half the width of an interval; a resample of `K` blocks has `(K - 1) / K` of the
        variance."""
        if not self.enough:
            return float("nan")
        spread = float(draws.std()) * np.sqrt(self.blocks / (self.blocks - 1.0))
        return spread * t_quantile(0.975, self.blocks - 1)

    def _with_ends(self, found: Contrast, low: float, high: float) -> Estimate:
        what = found.method.partition(",")[0]
        sure = bool(np.isfinite([low, high]).all())
        how = f"t interval from {self.blocks} resampled blocks of {round(self.block_s, 1):g} s"
        ends = {"low": low, "high": high} if sure else {"low": None, "high": None}
        return found.estimate().model_copy(
            update={**ends, "method": f"{what}, {how if sure else 'too few blocks'}"}
        )


def correlation_time(series: Floats, stretch: Floats) -> float:
    """Return the integrated correlation time of a series `[N]` about its median, in intervals.

    It is that of being above the median, which has moments whatever the series is. 1 where
    neighbours are independent; pairs are taken within a stretch.
    """
    above = np.where(series > np.median(series), 0.5, -0.5)
    edges = [0, *(np.flatnonzero(np.diff(stretch)) + 1), len(series)]
    sums = np.zeros(len(series))
    for begin, end in pairwise(edges):
        part = above[begin:end] - above.mean()
        spectrum = np.abs(np.fft.rfft(part, 2 * len(part))) ** 2
        sums[: len(part)] += np.fft.irfft(spectrum)[: len(part)]
    if not sums[0] > 0.0:
        return 1.0
    summed: NDArray[np.float64] = 2.0 * np.cumsum(sums / sums[0]) - 1.0
    enough = np.flatnonzero(np.arange(len(series)) >= _WINDOW * summed)
    return max(1.0, float(summed[enough[0] if len(enough) else -1]))
