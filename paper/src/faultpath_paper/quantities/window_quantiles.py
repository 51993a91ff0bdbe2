"""Quantiles over recorded windows, with whole scenes resampled."""

from collections.abc import Sequence

import numpy as np

from faultpath.stats.contrast import Contrast
from faultpath.stats.inputs import Floats, Numbers, by_scene_and_seed
from faultpath.stats.resamples import Resamples, quantiles


class WindowQuantiles:
    """Quantiles over the windows of some scenes, all on the same resamples of these scenes.

    Windows of a scene share its trial and disturbances, so they are not independent: a resample
    takes or leaves a scene with all its windows. Arrays are [windows, seeds], or
    [windows] for one seed; a quantile is taken over the windows of each seed, and then the mean
    over seeds (paper, Table VI: "mean of per-seed window medians").

    Args:
        scenes: Scene of each window, [windows].
        seed: Seed of the resamples; the scenes themselves name the stream.
        n_resamples: How many.
    """

    def __init__(self, scenes: Sequence[str], *, seed: int = 0, n_resamples: int = 10_000) -> None:
        if not scenes:
            raise ValueError("no window, so there is no quantile")
        names, self._scene = np.unique(np.asarray(scenes), return_inverse=True)
        label = "windows/" + "/".join(map(str, names))
        self.resamples = Resamples.draw(label, len(names), seed=seed, n_resamples=n_resamples)

    def value(self, values: Numbers, q: float, unit: str = "") -> Contrast:
        """Return the quantile ``q`` of ``values``."""
        seen, drawn = self._quantiles(by_scene_and_seed(values), q)
        return self._effect(seen, drawn, unit, f"quantile {q:g} over windows")

    def _quantiles(self, values: Floats, q: float) -> tuple[Floats, Floats]:
        """Return the quantiles of all windows [seeds] and of the resamples [resamples, seeds]."""
        if not 0.0 < q < 1.0:
            raise ValueError(f"a quantile lies between 0 and 1, not at {q}")
        if len(values) != len(self._scene):
            raise ValueError(f"{len(values)} values are not of {len(self._scene)} windows")
        counts = np.concatenate([np.ones((1, self.resamples.n_scenes)), self.resamples.counts])
        every = [quantiles(counts, column, self._scene, q) for column in values.T]
        rows: Floats = np.stack(every, axis=1)
        return rows[0], rows[1:]

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
