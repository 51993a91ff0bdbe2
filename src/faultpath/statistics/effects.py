"""Contrasts of paired arms: success, means and medians (paper, "Statistical Aggregation")."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics.contrast import Contrast
from faultpath.statistics.estimate import RULES, SCENES, SCENES_AND_SEEDS, RuleName
from faultpath.statistics.inputs import (
    Floats,
    Numbers,
    binary,
    by_scene_and_seed,
    paired,
    paired_binary,
)
from faultpath.statistics.resamples import Resamples, quantiles
from faultpath.statistics.score import SceneValues


def success_effect(
    first: Numbers,
    second: Numbers,
    resamples: Resamples,
    *,
    models: bool = False,
    sequential: bool = False,
    rule: RuleName = "exact",
) -> Contrast:
    """Return the difference in success in percentage points, from binary [scenes, seeds].

    ``models`` speaks of newly trained ones as well, of which each seed is one. ``sequential`` says
    that the number of scenes was not fixed beforehand: its interval and test hold at whatever scene
    one stops. A ``rule`` says how far the unseen may lie, of several seeds.
    """
    one, two = paired_binary(first, second)
    # Summed first, so that wins and losses of a scene cancel exactly.
    values = (one - two).sum(axis=1) / one.shape[1]
    scenes = SceneValues.paired(values, 1.0, 100.0, sequential, RULES[rule].prior)
    found = _mean(one - two, resamples, "pp", scenes, models)
    return replace(found, arms=(one, two))


def mean_effect(first: Numbers, second: Numbers, resamples: Resamples, unit: str) -> Contrast:
    """Return the mean difference of [scenes, seeds] in ``unit`` (distances, clearances)."""
    difference = np.subtract(*paired(first, second))
    return _mean(difference, resamples, unit)


def success_rate(outcomes: Numbers, resamples: Resamples) -> Contrast:
    """Return one arm's success in percent, from binary [scenes, seeds].

    For one seed the interval is Wilson's score interval of a proportion.
    """
    values = binary(by_scene_and_seed(outcomes), "outcomes")
    means = values.sum(axis=1) / values.shape[1]
    scenes = SceneValues(means - 0.5, bound=0.5, far=0.5, scale=100.0, centre=0.5)
    return replace(_mean(values, resamples, "percent", scenes), against_zero=False)


def _mean(
    values: Floats,
    resamples: Resamples,
    unit: str,
    scenes: SceneValues | None = None,
    models: bool = False,
) -> Contrast:
    n_scenes, n_seeds = values.shape
    resamples.check(n_scenes)
    if models and n_seeds < 2:
        raise ValueError("one seed says nothing about new seeds")
    if scenes is None:
        method = "percentile bootstrap of scenes"
    elif scenes.sequential:
        method = "confidence sequence by betting on scene means"
    else:
        name = "Wilson" if scenes.centre else "Tango"
        several = f"score on scene means ({name}'s, cluster-robust)"
        method = f"score ({name})" if n_seeds == 1 else several
        method = f"hull of {method} and Student's t over seeds" if models else method
    scale = scenes.scale if scenes else 1.0
    # Sums of binary outcomes are whole numbers and so exact; dividing last makes a resampled mean
    # of 0 exactly 0, on which "the interval excludes 0" depends.
    sums = resamples.counts @ values.sum(axis=1)
    return Contrast(
        value=float(scale * values.sum() / (n_scenes * n_seeds)),
        unit=unit,
        n_scenes=n_scenes,
        method=method,
        estimand=SCENES_AND_SEEDS if models else SCENES,
        n_seeds=n_seeds,
        per_seed=tuple(float(scale * total / n_scenes) for total in values.sum(axis=0)),
        draws=scale * sums / (n_scenes * n_seeds),
        resamples=resamples,
        scenes=scenes,
    )


def median_effect(
    first: Numbers, second: Numbers, joint: Numbers, resamples: Resamples, unit: str = "s"
) -> Contrast:
    """Return the median over scenes of the within-scene difference, where both arms count.

    ``first``, ``second`` and ``joint`` are [scenes, seeds] (or [scenes]); ``joint`` is true where
    both arms succeeded, and the arms' entries elsewhere are not read. Differences are averaged
    over the joint seeds of a scene. Whole scenes are resampled, so the number of jointly
    successful scenes varies between resamples, as it would between new libraries; the few
    resamples without any are left out. ``n_scenes`` counts the jointly successful scenes.
    """
    mask = np.asarray(joint, dtype=np.bool_)
    mask = mask[:, np.newaxis] if mask.ndim == 1 else mask
    difference = _masked(first, mask, "first") - _masked(second, mask, "second")
    resamples.check(len(difference))
    used = mask.any(axis=1)
    if not used.any():
        raise ValueError("no scene is jointly successful, so there is no median difference")
    means = difference[used].sum(axis=1) / mask[used].sum(axis=1)
    return Contrast(
        value=float(np.median(means)),
        draws=quantiles(resamples.counts, means, np.flatnonzero(used), 0.5),
        per_seed=tuple(
            float(np.median(column[seen]))
            for column, seen in zip(difference.T, mask.T, strict=True)
            if seen.any()
        ),
        unit=unit,
        method="median of paired differences, percentile bootstrap of scenes",
        n_scenes=int(used.sum()),
        n_seeds=mask.shape[1],
        resamples=resamples,
    )


def _masked(values: Numbers, mask: NDArray[np.bool_], name: str) -> Floats:
    array = np.asarray(values, dtype=np.float64)
    array = array[:, np.newaxis] if array.ndim == 1 else array
    if array.shape != mask.shape:
        raise ValueError(f"{name} has shape {array.shape}, joint has {mask.shape}")
    return by_scene_and_seed(np.where(mask, array, 0.0), name)
