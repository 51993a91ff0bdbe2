"""Effects: what is compared over scenes, before it is reduced to an estimate.

An ``Effect`` keeps what it was made from scene by scene, so that effects on the same scenes can be
subtracted, weighted and turned into a break-even frequency jointly.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faultpath.statistics.estimate import SCENES_AND_SEEDS, Estimate, SeedCounts
from faultpath.statistics.inputs import Floats
from faultpath.statistics.resamples import Resamples
from faultpath.statistics.score import SceneValues, combined

_DIGITS = 9
"""Of weighted sums, so that effects which cancel leave exactly 0."""


@dataclass(frozen=True, eq=False)
class Effect:
    """A difference, first minus second, or one arm's value.

    ``draws`` [resamples] are its bootstrap draws; ``per_seed`` the same quantity from each seed
    alone, in seed order. Bounded outcomes have their ``scenes`` as well, and a score interval:
    in place of the bootstrap's for given seeds, and beside it for new ones.
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
    scenes: SceneValues | None = field(default=None, repr=False)

    @property
    def resampled(self) -> bool:
        """Return whether the interval rests on ``draws``, alone or beside the score."""
        return self.scenes is None or self.estimand == SCENES_AND_SEEDS

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Return the score interval, or where outcomes have no bound the percentile interval.

        For newly trained models it is the hull of both, which holds what either does.
        """
        ends = [] if self.scenes is None else [self.scenes.interval(level)]
        if self.resampled:
            ends.append(percentile_interval(self.draws, level))
        return min(low for low, _ in ends), max(high for _, high in ends)

    def estimate(self, level: float = 0.95) -> Estimate:
        """Return the value with its interval at ``level``."""
        low, high = self.interval(level)
        drawn = f", {self.resamples.n_resamples} resamples" if self.resampled else ""
        return Estimate(
            value=self.value,
            low=low,
            high=high,
            level=level,
            unit=self.unit,
            method=f"{self.method}{drawn}",
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


def weighted_sum(weights: Sequence[float], effects: Sequence[Effect]) -> Effect:
    """Return a weighted sum of effects on the same scenes, scene by scene and draw by draw.

    ``ValueError`` for effects on other resamples, in other units or with another estimand.
    """
    first, *others = effects
    for other in others:
        check_joint(first, other)
    parts = [effect.scenes for effect in effects if effect.scenes is not None]
    alike = len({effect.n_seeds for effect in effects}) == 1
    by_seed = zip(*(effect.per_seed for effect in effects), strict=True) if alike else ()
    scenes = combined(weights, parts) if len(parts) == len(effects) else None
    return replace(
        first,
        value=round(sum(w * e.value for w, e in zip(weights, effects, strict=True)), _DIGITS) + 0.0,
        draws=np.dot(weights, [effect.draws for effect in effects]).round(_DIGITS),
        per_seed=tuple(
            round(sum(w * v for w, v in zip(weights, values, strict=True)), _DIGITS) + 0.0
            for values in by_seed
        ),
        method="score on scene differences (Tango's, cluster-robust)"
        if scenes is not None and not first.resampled
        else f"combined effects, {first.method}",
        n_seeds=max(effect.n_seeds for effect in effects),
        counts=None,
        scenes=scenes,
    )


def difference_of_effects(effect_a: Effect, effect_b: Effect) -> Effect:
    """Return B minus A, for example shared minus reconstruction-only."""
    return weighted_sum((-1.0, 1.0), (effect_a, effect_b))


def check_scenes(n_scenes: int, resamples: Resamples) -> None:
    """Refuse outcomes of another number of scenes than was resampled."""
    if n_scenes != resamples.n_scenes:
        raise ValueError(
            f"the outcomes have {n_scenes} scenes, the resamples {resamples.label!r} have "
            f"{resamples.n_scenes}"
        )


def check_joint(effect_a: Effect, effect_b: Effect) -> None:
    """Refuse effects that cannot be combined scene by scene."""
    if not effect_a.resamples.same_as(effect_b.resamples):
        raise ValueError("effects are joint only on the same resamples; draw them once and share")
    if effect_a.unit != effect_b.unit:
        raise ValueError(f"effects in {effect_a.unit!r} and {effect_b.unit!r} cannot be combined")
    if effect_a.estimand != effect_b.estimand:
        raise ValueError("one effect resamples seeds and the other does not")
    if effect_a.estimand == SCENES_AND_SEEDS and effect_a.n_seeds != effect_b.n_seeds:
        raise ValueError("effects that resample seeds need the same seeds")
