"""Effects of paired arms, with the scene bootstrap (paper, "Statistical Aggregation")."""

import numpy as np

from faultpath.statistics.effect import Effect, check_scenes
from faultpath.statistics.estimate import SCENES, SCENES_AND_SEEDS, SeedCounts
from faultpath.statistics.inputs import Floats, Numbers, binary, by_scene_and_seed, paired
from faultpath.statistics.paired import discordant_by_seed
from faultpath.statistics.resamples import Resamples
from faultpath.statistics.score import SceneValues


def success_effect(
    first: Numbers, second: Numbers, resamples: Resamples, *, resample_seeds: bool = False
) -> Effect:
    """Return the difference in success in percentage points, from binary [scenes, seeds]."""
    counts = discordant_by_seed(first, second)
    one, two = paired(first, second)
    # Summed first, so that wins and losses of a scene cancel exactly.
    scenes = SceneValues.paired((one - two).sum(axis=1) / one.shape[1], 1.0, 100.0)
    return _effect(one, two, resamples, "pp", 100.0, resample_seeds, counts, scenes)


def mean_effect(
    first: Numbers,
    second: Numbers,
    resamples: Resamples,
    unit: str,
    *,
    resample_seeds: bool = False,
) -> Effect:
    """Return the mean difference of [scenes, seeds] in ``unit`` (distances, clearances)."""
    return _effect(*paired(first, second), resamples, unit, 1.0, resample_seeds)


def success_rate(
    outcomes: Numbers, resamples: Resamples, *, resample_seeds: bool = False
) -> Effect:
    """Return one arm's success in percent, from binary [scenes, seeds].

    For one seed the interval is Wilson's score interval of a proportion.
    """
    values = binary(by_scene_and_seed(outcomes), "outcomes")
    means = values.sum(axis=1) / values.shape[1]
    scenes = SceneValues(means - 0.5, bound=0.5, far=0.5, scale=100.0, centre=0.5)
    none = np.zeros_like(values)
    return _effect(values, none, resamples, "percent", 100.0, resample_seeds, None, scenes)


def _effect(
    first: Floats,
    second: Floats,
    resamples: Resamples,
    unit: str,
    scale: float,
    resample_seeds: bool,
    counts: SeedCounts | None = None,
    scenes: SceneValues | None = None,
) -> Effect:
    difference = first - second
    n_scenes, n_seeds = difference.shape
    check_scenes(n_scenes, resamples)
    # Sums of binary outcomes are whole numbers and so exact; dividing last makes a resampled mean
    # of 0 exactly 0, on which "the interval excludes 0" depends.
    if resample_seeds:
        if n_seeds < 2:
            raise ValueError("one seed says nothing about new seeds; resample scenes alone")
        weights = resamples.seed_counts(n_seeds)
        sums = ((resamples.counts @ difference) * weights).sum(axis=1)
    else:
        sums = resamples.counts @ difference.sum(axis=1)
    return Effect(
        value=float(scale * difference.sum() / (n_scenes * n_seeds)),
        draws=scale * sums / (n_scenes * n_seeds),
        per_seed=tuple(float(scale * total / n_scenes) for total in difference.sum(axis=0)),
        unit=unit,
        method=_method(scenes, n_seeds, resample_seeds),
        estimand=SCENES_AND_SEEDS if resample_seeds else SCENES,
        n_scenes=n_scenes,
        n_seeds=n_seeds,
        resamples=resamples,
        counts=counts,
        scenes=scenes,
    )


def _method(scenes: SceneValues | None, n_seeds: int, resample_seeds: bool) -> str:
    drawn = f"percentile bootstrap of {'scenes and seeds' if resample_seeds else 'scenes'}"
    if scenes is None:
        return drawn
    name = "Wilson" if scenes.centre else "Tango"
    seeds = f"score on scene means ({name}'s, cluster-robust)"
    score = f"score ({name})" if n_seeds == 1 else seeds
    return f"hull of {score} and {drawn}" if resample_seeds else score
