"""Contrasts of paired variants: success, means, medians (paper, "Statistical Aggregation")."""

import math
from dataclasses import replace

import numpy as np

from faultpath.stats.contrast import Contrast
from faultpath.stats.estimate import SCENES, SCENES_AND_SEEDS, FixedSize
from faultpath.stats.inputs import Floats, Numbers, by_scene_and_seed, paired
from faultpath.stats.resamples import Resamples, quantiles
from faultpath.stats.score import SceneValues


def success_effect(
    first: Numbers,
    second: Numbers,
    resamples: Resamples | None = None,
    *,
    models: bool = False,
    sequential: bool = False,
    test: FixedSize = "unconditional",
) -> Contrast:
    """Return the difference in success in percentage points.

    A pair with a missing outcome is left out: a scene's difference is the mean over its other
    seeds, and a scene without any does not count.

    Args:
        first: Binary outcomes of the first variant, [scenes, seeds]; NaN where one is missing.
        second: Outcomes of the second variant in the same scenes.
        resamples: Resamples of the scenes that count, for percentile intervals; not needed for the
            test, nor for its interval.
        models: Whether the result is to hold for newly trained models too; each seed is one.
        sequential: Whether the number of scenes was not fixed beforehand. Interval and test then
            hold at whatever scene the audit stops.
        test: See `TestKind`; the interval goes with the test.
    """
    one, two = paired(first, second, binary=True)
    pairs = one - two
    pairs = pairs[~np.isnan(pairs).all(axis=1)]
    if not len(pairs):
        raise ValueError("no pair has both outcomes, so there is no difference")
    if models:  # a training without any pair tells nothing about trainings
        pairs = pairs[:, ~np.isnan(pairs).all(axis=0)]
    # Summed first, so that wins and losses of a scene cancel exactly.
    values = seed_sums(pairs) / pairs.shape[1]
    scenes = SceneValues.paired(values, 1.0, 100.0, "sequential" if sequential else test)
    return replace(_mean(pairs, resamples, "pp", scenes, models), pairs=pairs)


def seed_sums(values: Floats) -> Floats:
    """Return sums [scenes] of ``values`` [scenes, seeds]; NaN counts as the mean of its scene."""
    ran = (~np.isnan(values)).sum(axis=1)
    return np.nansum(values, axis=1) * (values.shape[1] / ran)


def mean_effect(first: Numbers, second: Numbers, resamples: Resamples, unit: str) -> Contrast:
    """Return the mean difference of [scenes, seeds] in ``unit`` (distances, clearances)."""
    return _mean(np.subtract(*paired(first, second)), resamples, unit)


def success_rate(outcomes: Numbers, resamples: Resamples) -> Contrast:
    """Return one variant's success in percent, from binary [scenes, seeds].

    For one seed the interval is Wilson's score interval of a proportion.
    """
    values = by_scene_and_seed(outcomes, "outcomes", binary=True)
    means = values.sum(axis=1) / values.shape[1]
    scenes = SceneValues(means - 0.5, bound=0.5, far=0.5, scale=100.0, centre=0.5)
    return replace(_mean(values, resamples, "percent", scenes), against_zero=False)


def _mean(
    values: Floats,
    resamples: Resamples | None,
    unit: str,
    scenes: SceneValues | None = None,
    models: bool = False,
) -> Contrast:
    n_scenes, n_seeds = values.shape
    if resamples:
        resamples.check(n_scenes)
    if models and n_seeds < 2:
        raise ValueError("one seed says nothing about new seeds")
    if scenes is None:
        method = "percentile bootstrap of scenes"
    elif scenes.test == "sequential":
        method = "confidence sequence by betting on scene means"
    else:
        name = "Wilson" if scenes.centre else "Tango"
        by_scene = f"score on scene means ({name}'s, cluster-robust)"
        method = f"score ({name})" if n_seeds == 1 else by_scene
        method = f"hull of {method} and Student's t over seeds" if models else method
    scale = scenes.scale if scenes else 1.0
    # Sums of binary outcomes are whole numbers and so exact; dividing last makes a resampled mean
    # of 0 exactly 0, on which "the interval excludes 0" depends.
    ran = ~np.isnan(values)
    totals = seed_sums(values)
    sums = resamples.sums(totals) if resamples else np.empty(0)
    return Contrast(
        value=float(scale * (values if ran.all() else totals).sum() / (n_scenes * n_seeds)),
        unit=unit,
        n_scenes=n_scenes,
        method=method,
        estimand=SCENES_AND_SEEDS if models else SCENES,
        n_seeds=n_seeds,
        per_seed=tuple(
            float(scale * total / count) if count else math.nan
            for total, count in zip(np.nansum(values, axis=0), ran.sum(axis=0), strict=True)
        ),
        draws=scale * sums / (n_scenes * n_seeds),
        resamples=resamples,
        scenes=scenes,
    )


def median_effect(
    first: Numbers, second: Numbers, joint: Numbers, resamples: Resamples
) -> Contrast:
    """Return the median over scenes of the within-scene difference, where both variants succeed.

    ``first``, ``second`` and ``joint`` are [scenes, seeds] (or [scenes]); ``joint`` is true where
    both variants succeeded, and the variants' entries elsewhere are not read. Differences are
    averaged over the joint seeds of a scene. Whole scenes are resampled, so the number of jointly
    successful scenes varies between resamples, as it would between new libraries; the few resamples
    without any are left out. ``n_scenes`` counts the jointly successful scenes.
    """
    if not np.shape(first) == np.shape(second) == np.shape(joint):
        shapes = f"{np.shape(first)}, {np.shape(second)} and {np.shape(joint)}"
        raise ValueError(f"first, second and joint need one shape, got {shapes}")
    mask = by_scene_and_seed(joint, "joint", binary=True) == 1.0
    difference = np.subtract(*paired(*(np.where(joint, part, 0.0) for part in (first, second))))
    resamples.check(len(difference))
    used = mask.any(axis=1)
    if not used.any():
        raise ValueError("no scene is jointly successful, so there is no median difference")
    means = difference[used].sum(axis=1) / mask[used].sum(axis=1)
    return Contrast(
        value=float(np.median(means)),
        draws=quantiles(resamples.counts, means, np.flatnonzero(used), 0.5),
        per_seed=tuple(
            float(np.median(column[joint_scenes]))
            for column, joint_scenes in zip(difference.T, mask.T, strict=True)
            if joint_scenes.any()
        ),
        unit="s",
        method="median of paired differences, percentile bootstrap of scenes",
        n_scenes=int(used.sum()),
        n_seeds=mask.shape[1],
        resamples=resamples,
    )
