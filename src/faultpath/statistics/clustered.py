"""Quantiles over windows, with intervals that resample whole scenes.

Windows of a scene share a vehicle, a flight and its wind, so they are not independent: a resample
takes or leaves a scene with all its windows. Arrays are [windows, seeds], or [windows] for one
seed; a quantile is taken over the windows of each seed, and then the mean over seeds (paper, Table
VI: "mean of per-seed window medians").
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics.contrast import Contrast
from faultpath.statistics.inputs import Floats, Numbers, by_scene_and_seed, paired
from faultpath.statistics.resamples import Resamples

N_RESAMPLES = 10_000

_SLACK = 1e-9
"""On a count of windows: q times a count may miss the whole number that it is by rounding."""


class WindowQuantiles:
    """Quantiles over the windows of some scenes, all on the same resamples of these scenes.

    Args:
        scenes: Scene of each window, [windows].
        seed: Seed of the resamples; the scenes themselves name the stream.
        n_resamples: How many.
    """

    def __init__(
        self, scenes: Sequence[str], *, seed: int = 0, n_resamples: int = N_RESAMPLES
    ) -> None:
        if not scenes:
            raise ValueError("no window, so there is no quantile")
        names, self._scene = np.unique(np.asarray(scenes), return_inverse=True)
        label = "windows/" + "/".join(map(str, names))
        self.resamples = Resamples.draw(label, len(names), seed=seed, n_resamples=n_resamples)

    def value(self, values: Numbers, q: float, unit: str = "") -> Contrast:
        """Return the quantile ``q`` of ``values``."""
        array = self._checked(by_scene_and_seed(values), q)
        return self._effect(self._quantiles(array, q), unit, f"quantile {q:g} over windows")

    def log_ratio(self, first: Numbers, second: Numbers, q: float) -> Contrast:
        """Return the natural logarithm of the ratio of two quantiles, which must be positive.

        Without a difference it is 0, as for other contrasts. Over seeds it is the mean logarithm.
        """
        arms = paired(first, second)
        one, two = (self._quantiles(self._checked(array, q), q) for array in arms)
        if not ((one > 0.0).all() and (two > 0.0).all()):
            raise ValueError("a ratio needs quantiles above 0 in every resample")
        what = f"log ratio of quantiles {q:g} over windows"
        return self._effect(np.log(one) - np.log(two), "log", what)

    def _checked(self, values: Floats, q: float) -> Floats:
        if not 0.0 < q < 1.0:
            raise ValueError(f"a quantile lies between 0 and 1, not at {q}")
        if len(values) != len(self._scene):
            raise ValueError(f"{len(values)} values are not of {len(self._scene)} windows")
        return values

    def _quantiles(self, values: Floats, q: float) -> Floats:
        return np.stack([self._column(column, q) for column in values.T], axis=1)

    def _column(self, values: Floats, q: float) -> Floats:
        order = np.argsort(values, kind="stable")
        ordered = values[order]
        # Windows of each scene among the least so many: whole numbers, exact in any order of sums.
        reached = np.zeros((self.resamples.n_scenes, len(values)))
        reached[self._scene[order], np.arange(len(values))] = 1.0
        np.cumsum(reached, axis=1, out=reached)
        whole = np.ones((1, self.resamples.n_scenes))
        blocks = (whole, *self.resamples.blocks())
        # A block is cut further: there are many more windows than scenes.
        parts = [part for block in blocks for part in _cut(block, len(values))]
        return np.concatenate([_quantile(ordered, part @ reached, q) for part in parts])

    def _effect(self, quantiles: Floats, unit: str, what: str) -> Contrast:
        means = quantiles.mean(axis=1)
        return Contrast(
            value=float(means[0]),
            draws=means[1:],
            per_seed=tuple(float(value) for value in quantiles[0]),
            unit=unit,
            method=f"{what}, percentile bootstrap of scenes",
            n_scenes=self.resamples.n_scenes,
            n_seeds=quantiles.shape[1],
            resamples=self.resamples,
        )


def _quantile(ordered: Floats, reached: Floats, q: float) -> Floats:
    """Return the quantile of ascending values [n] in every resample.

    ``reached`` [resamples, n] counts what a resample has of the values up to and with each.

    Where q of the count is a whole number it is the mean of the two values beside it, so that the
    quantile 0.5 is the median.
    """
    rank = q * reached[:, -1:]
    lower = (reached < rank - _SLACK).sum(axis=1)
    upper = (reached <= rank + _SLACK).sum(axis=1)
    return (ordered[lower] + ordered[upper]) / 2.0


def _cut(block: Floats, n_windows: int) -> list[NDArray[np.float64]]:
    step = max(1, 100_000 // n_windows)
    return [block[first : first + step] for first in range(0, len(block), step)]
