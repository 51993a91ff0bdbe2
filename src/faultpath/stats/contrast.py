"""A difference between paired variants, with its interval and its test.

A ``Contrast`` keeps its values scene by scene, so that contrasts on the same scenes can be
subtracted, weighted and turned into a break-even frequency jointly.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from operator import add

import numpy as np

from faultpath.stats.distributions import t_interval
from faultpath.stats.estimate import SCENES, SCENES_AND_SEEDS, Estimate, PairedTest, Sign
from faultpath.stats.inputs import Floats
from faultpath.stats.resamples import Resamples
from faultpath.stats.score import SceneValues, combined

_DIGITS = 9
"""Digits of weighted sums, so that contrasts which cancel leave exactly 0."""


@dataclass(frozen=True, eq=False)
class Contrast:
    """A difference over scenes, first minus second, or another value that scenes have.

    ``draws`` [resamples] are its bootstrap draws; ``per_seed`` the same quantity from each seed
    alone, in seed order, NaN where none of its pairs ran. Bounded outcomes have ``scenes`` too, and
    with them a score interval in place of the bootstrap's; for new seeds it is widened to Student's
    t interval over ``per_seed``. Without draws and scenes there is no interval. ``pairs`` [scenes,
    seeds] are the differences of binary outcomes, NaN where an outcome is missing.
    """

    value: float
    unit: str
    n_scenes: int
    method: str = ""
    estimand: str = SCENES
    n_seeds: int = 1
    per_seed: tuple[float, ...] = ()
    draws: Floats = field(default_factory=lambda: np.empty(0), repr=False)
    resamples: Resamples | None = field(default=None, repr=False)
    pairs: Floats | None = field(default=None, repr=False)
    scenes: SceneValues | None = field(default=None, repr=False)
    against_zero: bool = True
    """Whether 0 means no difference; not for rates, ratios and counts."""
    test: PairedTest | None = None
    """See `with_test`."""

    @property
    def won(self) -> tuple[tuple[int, int], ...] | None:
        """By seed: number of scenes in which only the first succeeded, or only the second."""
        if self.pairs is None:
            return None
        return tuple((int((c > 0).sum()), int((c < 0).sum())) for c in self.pairs.T)

    @property
    def ahead(self) -> tuple[int, int]:
        """Number of scenes in which the first was ahead over the seeds, or the second."""
        values = np.zeros(0) if self.scenes is None else self.scenes.values
        return int((values > 0).sum()), int((values < 0).sum())

    @property
    def rounding(self) -> float:
        """The least variance of a seed's effect.

        A share of n scenes is known to 1 / n only. Without this, seeds that happen to agree would
        look certain.
        """
        return (100.0 / self.n_scenes) ** 2 / 12.0 if self.unit == "pp" else 0.0

    def ends(self, level: float) -> tuple[float, float] | None:
        """Return the score interval, or where outcomes have no bound the percentile interval.

        For newly trained models it is the hull of the score interval and Student's: the former
        allows for differences that no scene showed, the latter for how trainings differ.
        """
        if self.scenes is None:
            return percentile_interval(self.draws, level) if self.draws.size else None
        low, high = self.scenes.interval(level)
        if self.estimand == SCENES_AND_SEEDS:
            ends = t_interval(np.asarray(self.per_seed), level, self.rounding)
            low, high = min(low, float(ends[0])), max(high, float(ends[1]))
        return low, high

    @cached_property
    def interval(self) -> tuple[float, float] | None:
        """The 95 % interval."""
        return self.ends(0.95)

    def estimate(self) -> Estimate:
        """Return the value with its 95 % interval, for storing."""
        low, high = self.interval or (None, None)
        resamples = self.resamples.n_resamples if self.resamples else 0
        return Estimate(
            value=self.value,
            low=low,
            high=high,
            unit=self.unit,
            method=self.method + (f", {resamples} resamples" if self.scenes is None else ""),
            estimand=self.estimand,
            n_scenes=self.n_scenes,
            n_seeds=self.n_seeds,
            per_seed=self.per_seed,
            won=self.won,
        )

    @property
    def sign_of_interval(self) -> Sign:
        """Side of 0 on which the whole interval lies; 0 when it touches 0."""
        low, high = self.interval or (0.0, 0.0)
        return 1 if low > 0 else -1 if high < 0 else 0

    @property
    def sign(self) -> Sign:
        """Side of 0 on which it is significant within its family; 0 for neither."""
        return self.test.sign if self.test else 0


def percentile_interval(draws: Floats, level: float = 0.95) -> tuple[float, float]:
    """Return the central ``level`` percentile interval of ``draws`` [resamples].

    The upper end is the mirrored lower end of the negated draws, so that swapping the variants
    mirrors the interval to the bit.
    """
    if not 0.0 < level < 1.0:
        raise ValueError(f"the level of an interval lies between 0 and 1, not at {level}")
    tail = (1.0 - level) / 2.0
    low = float(np.quantile(draws, tail))
    high = 0.0 - float(np.quantile(-draws, tail))
    return low + 0.0, high


def weighted_sum(weights: Sequence[float], contrasts: Sequence[Contrast]) -> Contrast:
    """Return a weighted sum of contrasts on the same scenes, scene by scene and draw by draw.

    ``ValueError`` for contrasts on other scenes, in other units or with another estimand.
    """
    first, *others = contrasts
    for other in others:
        check_joint(first, other)
    parts = [part.scenes for part in contrasts if part.scenes is not None]
    alike = len({part.n_seeds for part in contrasts}) == 1
    by_seed = zip(*(part.per_seed for part in contrasts), strict=True) if alike else ()
    scenes = combined(weights, parts) if len(parts) == len(contrasts) else None
    if scenes is None or first.estimand == SCENES_AND_SEEDS:
        method = f"combined effects, {first.method}"
    elif scenes.test == "sequential":
        method = "confidence sequence by betting on scene differences"
    else:
        method = "score on scene differences (Tango's, cluster-robust)"
    return replace(
        first,
        value=_dot(weights, [part.value for part in contrasts]),
        draws=np.dot(weights, [part.draws for part in contrasts]).round(_DIGITS),
        per_seed=tuple(_dot(weights, values) for values in by_seed),
        method=method,
        n_seeds=max(part.n_seeds for part in contrasts),
        pairs=None,
        scenes=scenes,
        test=None,
    )


def _dot(weights: Sequence[float], values: Sequence[float]) -> float:
    products = (w * v for w, v in zip(weights, values, strict=True))
    return round(ordered_sum(products), _DIGITS) + 0.0


def ordered_sum(values: Iterable[float]) -> float:
    """Add from left to right: `sum` compensates from Python 3.12 on, which changes last bits."""
    return reduce(add, values, 0.0)


def change(before: Contrast, after: Contrast) -> Contrast:
    """Return the change of a contrast, for example from reconstruction-only to shared."""
    return weighted_sum((-1.0, 1.0), (before, after))


def check_joint(one: Contrast, two: Contrast) -> None:
    """Refuse contrasts that cannot be combined scene by scene.

    That both are of the same scenes in the same order is the caller's to see to: a contrast does
    not hold their names.
    """
    if one.resamples is None and two.resamples is None:
        if one.n_scenes != two.n_scenes:
            raise ValueError(
                f"effects of {one.n_scenes} and of {two.n_scenes} scenes cannot be combined"
            )
    elif not (one.resamples and two.resamples and one.resamples.same_as(two.resamples)):
        raise ValueError("effects are joint only on the same resamples; draw them once and share")
    if one.unit != two.unit:
        raise ValueError(f"effects in {one.unit!r} and {two.unit!r} cannot be combined")
    if one.estimand != two.estimand:
        raise ValueError("one effect is for new seeds and the other is not")
    if one.estimand == SCENES_AND_SEEDS and one.n_seeds != two.n_seeds:
        raise ValueError("effects for new seeds need the same seeds")
