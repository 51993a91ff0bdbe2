"""Quantiles over windows, with intervals that resample whole scenes.

Windows of a scene share a vehicle, a flight and its wind, so they are not independent: a resample
takes or leaves a scene with all its windows. Arrays are [windows, seeds], or [windows] for one
seed; a quantile is taken over the windows of each seed, and then the mean over seeds (paper, Table
VI: "mean of per-seed window medians").
"""

from collections.abc import Sequence

import numpy as np

from faultpath.statistics.contrast import Contrast
from faultpath.statistics.inputs import Floats, Numbers, by_scene_and_seed, paired
from faultpath.statistics.resamples import Resamples, quantiles

N_RESAMPLES = 10_000


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
        found = self._quantiles(by_scene_and_seed(values), q)
        return self._effect(*found, unit, f"quantile {q:g} over windows")

    def log_ratio(self, first: Numbers, second: Numbers, q: float) -> Contrast:
        """Return the natural logarithm of the ratio of two quantiles, which must be positive.

        Without a difference it is 0, as for other contrasts. Over seeds it is the mean logarithm.
        """
        one, two = (self._quantiles(array, q) for array in paired(first, second))
        if not all((part > 0.0).all() for part in (*one, *two)):
            raise ValueError("a ratio needs quantiles above 0 in every resample")
        seen, drawn = (np.log(a) - np.log(b) for a, b in zip(one, two, strict=True))
        return self._effect(seen, drawn, "log", f"log ratio of quantiles {q:g} over windows")

    def _quantiles(self, values: Floats, q: float) -> tuple[Floats, Floats]:
        """Return those of the scenes as they are [seeds], and the resampled [resamples, seeds]."""
        if not 0.0 < q < 1.0:
            raise ValueError(f"a quantile lies between 0 and 1, not at {q}")
        if len(values) != len(self._scene):
            raise ValueError(f"{len(values)} values are not of {len(self._scene)} windows")
        counts = np.concatenate([np.ones((1, self.resamples.n_scenes)), self.resamples.counts])
        every = [quantiles(counts, column, self._scene, q) for column in values.T]
        found: Floats = np.stack(every, axis=1)
        return found[0], found[1:]

    def _effect(self, seen: Floats, drawn: Floats, unit: str, what: str) -> Contrast:
        return Contrast(
            value=float(seen.mean()),
            draws=drawn.mean(axis=1),
            per_seed=tuple(float(value) for value in seen),
            unit=unit,
            method=f"{what}, percentile bootstrap of scenes",
            n_scenes=self.resamples.n_scenes,
            n_seeds=len(seen),
            resamples=self.resamples,
        )
