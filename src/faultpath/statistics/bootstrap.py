"""Scene-bootstrap percentile intervals for paired effects (paper, "Statistical Aggregation").

An ``Effect`` keeps its bootstrap draws, so that effects on the same resamples can be subtracted
or turned into a break-even frequency jointly. ``Effect.estimate()`` reduces it to what is reported.
"""

from dataclasses import dataclass, field

import numpy as np

from faultpath.statistics.estimate import SCENES, SCENES_AND_SEEDS, Estimate, Reversal, SeedCounts
from faultpath.statistics.inputs import Floats, Numbers, binary, by_scene_and_seed, paired
from faultpath.statistics.paired import discordant_by_seed
from faultpath.statistics.resamples import Resamples


@dataclass(frozen=True, eq=False)
class Effect:
    """A difference, first minus second, with its bootstrap draws.

    ``draws`` is [resamples]; ``per_seed`` the same quantity from each seed alone, in seed order.
    """

    value: float
    draws: Floats = field(repr=False)
    per_seed: tuple[float, ...]
    unit: str
    method: str
    estimand: str
    n_scenes: int
    n_seeds: int
    resamples: Resamples = field(repr=False)
    counts: SeedCounts | None = None

    def estimate(self, level: float = 0.95) -> Estimate:
        """Return the value with its percentile interval at ``level``."""
        low, high = percentile_interval(self.draws, level)
        return Estimate(
            value=self.value,
            low=low,
            high=high,
            level=level,
            unit=self.unit,
            method=f"{self.method}, {self.resamples.n_resamples} resamples",
            estimand=self.estimand,
            n_scenes=self.n_scenes,
            n_seeds=self.n_seeds,
            counts=self.counts,
            per_seed=self.per_seed,
        )


def percentile_interval(draws: Floats, level: float = 0.95) -> tuple[float, float]:
    """Return the central ``level`` percentile interval of ``draws`` [resamples].

    The upper end is taken as the mirrored lower end of the negated draws, so that swapping the
    arms mirrors the interval to the bit.
    """
    if not 0.0 < level < 1.0:
        raise ValueError(f"the level of an interval lies between 0 and 1, not at {level}")
    tail = (1.0 - level) / 2.0
    low = float(np.quantile(draws, tail))
    high = 0.0 - float(np.quantile(-draws, tail))
    return low + 0.0, high


def success_effect(
    first: Numbers, second: Numbers, resamples: Resamples, *, resample_seeds: bool = False
) -> Effect:
    """Return the difference in success in percentage points, from binary [scenes, seeds]."""
    counts = discordant_by_seed(first, second)
    return _effect(*paired(first, second), resamples, "pp", 100.0, resample_seeds, counts)


def mean_effect(
    first: Numbers,
    second: Numbers,
    resamples: Resamples,
    unit: str,
    *,
    resample_seeds: bool = False,
) -> Effect:
    """Return the mean difference of [scenes, seeds] in ``unit`` (distances, clearances)."""
    return _effect(*paired(first, second), resamples, unit, 1.0, resample_seeds, None)


def success_rate(
    outcomes: Numbers, resamples: Resamples, *, resample_seeds: bool = False
) -> Effect:
    """Return one arm's success in percent, from binary [scenes, seeds]."""
    values = binary(by_scene_and_seed(outcomes), "outcomes")
    return _effect(values, np.zeros_like(values), resamples, "percent", 100.0, resample_seeds, None)


def mean_value(
    values: Numbers, resamples: Resamples, unit: str, *, resample_seeds: bool = False
) -> Effect:
    """Return one arm's mean of [scenes, seeds] in ``unit``."""
    array = by_scene_and_seed(values)
    return _effect(array, np.zeros_like(array), resamples, unit, 1.0, resample_seeds, None)


def _effect(
    first: Floats,
    second: Floats,
    resamples: Resamples,
    unit: str,
    scale: float,
    resample_seeds: bool,
    counts: SeedCounts | None,
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
        method=f"percentile bootstrap of {'scenes and seeds' if resample_seeds else 'scenes'}",
        estimand=SCENES_AND_SEEDS if resample_seeds else SCENES,
        n_scenes=n_scenes,
        n_seeds=n_seeds,
        resamples=resamples,
        counts=counts,
    )


def difference_of_effects(effect_a: Effect, effect_b: Effect) -> Effect:
    """Return B minus A draw by draw, for example shared minus reconstruction-only."""
    check_joint(effect_a, effect_b)
    same_seeds = effect_a.n_seeds == effect_b.n_seeds
    return Effect(
        value=effect_b.value - effect_a.value,
        draws=effect_b.draws - effect_a.draws,
        per_seed=tuple(b - a for a, b in zip(effect_a.per_seed, effect_b.per_seed, strict=True))
        if same_seeds
        else (),
        unit=effect_a.unit,
        method=f"difference of two effects, {effect_a.method}",
        estimand=effect_a.estimand,
        n_scenes=effect_a.n_scenes,
        n_seeds=max(effect_a.n_seeds, effect_b.n_seeds),
        resamples=effect_a.resamples,
    )


def reversal(effect_a: Effect, effect_b: Effect, level: float = 0.95) -> Reversal:
    """Return whether the effect turns its sign from A to B, and whether every seed alone agrees."""
    change = difference_of_effects(effect_a, effect_b).estimate(level)
    sign_a, sign_b = np.sign(effect_a.value), np.sign(effect_b.value)
    opposite = bool(sign_a * sign_b < 0)
    alike = all(np.sign(v) == sign_a for v in effect_a.per_seed) and all(
        np.sign(v) == sign_b for v in effect_b.per_seed
    )
    return Reversal(
        effect_a=effect_a.estimate(level),
        effect_b=effect_b.estimate(level),
        change=change,
        detected=opposite and change.detected_sign != 0,
        in_every_seed=opposite and alike,
    )


def check_scenes(n_scenes: int, resamples: Resamples) -> None:
    """Refuse outcomes of another number of scenes than was resampled."""
    if n_scenes != resamples.n_scenes:
        raise ValueError(
            f"the outcomes have {n_scenes} scenes, the resamples {resamples.label!r} have "
            f"{resamples.n_scenes}"
        )


def check_joint(effect_a: Effect, effect_b: Effect) -> None:
    """Refuse effects that cannot be combined draw by draw."""
    if not effect_a.resamples.same_as(effect_b.resamples):
        raise ValueError("effects are joint only on the same resamples; draw them once and share")
    if effect_a.unit != effect_b.unit:
        raise ValueError(f"effects in {effect_a.unit!r} and {effect_b.unit!r} cannot be combined")
    if effect_a.estimand != effect_b.estimand:
        raise ValueError("one effect resamples seeds and the other does not")
    if effect_a.estimand == SCENES_AND_SEEDS and effect_a.n_seeds != effect_b.n_seeds:
        raise ValueError("effects that resample seeds need the same seeds")
