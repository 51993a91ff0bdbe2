"""Quantities of recorded windows: quantiles of errors and responses, compared on common windows."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from faultpath.stats.contrast import Contrast, weighted_sum
from faultpath.stats.inputs import Numbers, by_scene_and_seed
from faultpath.stats.resamples import Resamples, quantiles
from faultpath_paper.evidence.table import QUANTITIES, EvidenceTable, Measured, Measurement
from faultpath_paper.results import NotRun, Results, Undecidable, decisive, quantity


class WindowQuantiles:
    """Quantiles over the windows of some scenes, all on the same resamples of these scenes.

    Windows of a scene share its trial and disturbances, so they are not independent: a resample
    takes or leaves a scene with all its windows. The scenes themselves, one for each window, name
    the stream of the resamples.
    """

    def __init__(self, scenes: Sequence[str], n_resamples: int = 10_000) -> None:
        if not scenes:
            raise ValueError("no window, so there is no quantile")
        names, self._scene = np.unique(np.asarray(scenes), return_inverse=True)
        label = "windows/" + "/".join(map(str, names))
        self.resamples = Resamples.draw(label, len(names), seed=0, n_resamples=n_resamples)

    def value(self, values: Numbers, q: float, unit: str = "") -> Contrast:
        """Return the quantile `q` of `values` [windows], of one seed."""
        column, n_scenes = by_scene_and_seed(values)[:, 0], self.resamples.n_scenes
        if len(column) != len(self._scene):
            raise ValueError(f"{len(column)} values are not of {len(self._scene)} windows")
        counts = np.concatenate([np.ones((1, n_scenes)), self.resamples.counts])
        rows = quantiles(counts, column, self._scene, q)
        return Contrast(
            value=float(rows[0]),
            draws=rows[1:],
            per_seed=(float(rows[0]),),
            unit=unit,
            method=f"quantile {q:g} over windows, percentile bootstrap of scenes",
            n_scenes=n_scenes,
            resamples=self.resamples,
        )


Subject: TypeAlias = tuple[Measurement, ...]
"""A measurement of each seed: the quantile is taken seed by seed, and then the mean (paper,
Table VI: "mean of per-seed window medians")."""

TELLING_SHARE = 0.2
"""A share of a median whose change a run must be able to detect for its absence to say anything."""


@quantity
def median(results: Results, subject: Subject) -> Contrast:
    """Return the median of a subject."""
    (one,) = joint_quantiles(results, 0.5, subject)
    return decisive(replace(one, against_zero=False))


@quantity
def difference_of_quantiles(
    results: Results, first: Subject, second: Subject, q: float = 0.5
) -> Contrast:
    """Return a quantile of `first` minus that of `second`."""
    one, two = joint_quantiles(results, q, first, second)
    return decisive(weighted_sum([1, -1], [one, two]), TELLING_SHARE * two.value)


@quantity
def difference_of_changes(
    results: Results, first: tuple[Subject, Subject], second: tuple[Subject, Subject], *, size: bool
) -> Contrast:
    """Return how much more the median changes over `first`, from one to the next, than `second`.

    `size`: changes are compared whatever their sign.
    """
    ends = joint_quantiles(results, 0.5, *first, *second)
    changes = [weighted_sum([-1, 1], ends[:2]), weighted_sum([-1, 1], ends[2:])]
    if size:
        changes = [replace(c, value=abs(c.value), draws=np.abs(c.draws)) for c in changes]
    return decisive(weighted_sum([1, -1], changes))


@quantity
def ratio(results: Results, first: Subject, second: Subject) -> Contrast:
    """Return the median of `first` over that of `second`."""
    one, two = joint_quantiles(results, 0.5, first, second)
    if not (two.value > 0 and bool((two.draws > 0).all())):
        raise Undecidable("the median that is divided by is 0")
    draws = one.draws / two.draws
    value = one.value / two.value
    return decisive(replace(one, value=value, draws=draws, unit="times", against_zero=False))


def joint_quantiles(results: Results, q: float, *subjects: Subject) -> list[Contrast]:
    """Return a quantile of each subject on shared resamples, over the seeds that all have.

    A subject of one seed stands beside all seeds of the others. `NotRun` when a subject was not
    measured, or on other windows.
    """
    several = [tuple(m for m in subject if m in results.evidence) for subject in subjects]
    for run, subject in zip(several, subjects, strict=True):
        if not run:
            results.measured(subject[0])  # says what is missing
    fixed = [len(subject) == 1 for subject in subjects]
    seeds = [{m.seed for m in run} for run, one in zip(several, fixed, strict=True) if not one]
    kept = [
        tuple(m for m in run if one or all(m.seed in others for others in seeds))
        for run, one in zip(several, fixed, strict=True)
    ]
    if not all(kept):
        raise NotRun(f"a seed that all measurements beside {subjects[0][0].subject} share")
    windows = results.measured(kept[0][0])
    if not len(windows):
        raise NotRun(f"a window of {kept[0][0].subject}")
    for measurement in (m for subject in kept for m in subject):
        if not results.measured(measurement).same_windows(windows):
            raise NotRun(f"{measurement.subject} on the windows of {kept[0][0].subject}")
    return [_mean(results.evidence, subject, q) for subject in kept]


def quantile(results: Results, measurement: Measurement, q: float = 0.5) -> float:
    """Return a quantile over windows; `NotRun` without any."""
    values = results.measured(measurement).values
    if not len(values):
        raise NotRun(f"a window for {measurement.subject}")
    # As `statistics.effects` takes it, so that tables and claims agree to the bit.
    return float(np.quantile(values, q, method="averaged_inverted_cdf"))


def mean_of_medians(results: Results, by_seed: Iterable[Measurement]) -> float:
    """Return the mean over seeds of their window medians, over the seeds that were measured."""
    medians: list[float] = []
    for measurement in by_seed:
        with suppress(NotRun):
            medians.append(quantile(results, measurement))
    if not medians:
        raise NotRun("a measurement of any seed")
    return float(np.mean(medians))


def _mean(evidence: EvidenceTable, subject: Subject, q: float) -> Contrast:
    effects = [_quantile(evidence[m], q, QUANTITIES[m.quantity]) for m in subject]
    mean = weighted_sum([1 / len(effects)] * len(effects), effects)
    per_seed = tuple(effect.value for effect in effects)
    return replace(mean, per_seed=per_seed, n_seeds=len(effects))


@lru_cache(maxsize=512)
def _quantile(measured: Measured, q: float, unit: str) -> Contrast:
    return _resampled(measured.scenes).value(measured.values, q, unit)


@lru_cache(maxsize=8)
def _resampled(scenes: tuple[str, ...]) -> WindowQuantiles:
    return WindowQuantiles(scenes)
