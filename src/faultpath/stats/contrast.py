"""The one type of what paired variants show: a difference with its interval, its test and its
decision.

A ``Contrast`` keeps what it was made from scene by scene, so that contrasts on the same scenes can
be subtracted, weighted and turned into a break-even frequency jointly.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from operator import add

import numpy as np

from faultpath.stats.distributions import normal_quantile, t_interval
from faultpath.stats.estimate import (
    SCENES,
    SCENES_AND_SEEDS,
    Estimate,
    PairedTest,
    Sign,
)
from faultpath.stats.inputs import Floats
from faultpath.stats.power import detectable, fewest_scenes
from faultpath.stats.resamples import Resamples
from faultpath.stats.score import SceneValues, combined

MIN_SCENES = fewest_scenes()
"""With fewer, nothing is called a detection: even if all agree no test rejects at 0.05."""
ROUNDING = 1e-12
"""Draws that spread no more than this are all the same."""
_DIGITS = 9
"""Digits of weighted sums, so that contrasts which cancel leave exactly 0."""


@dataclass(frozen=True, eq=False)
class Contrast:
    """A difference over scenes, first minus second, or what else scenes show, as one variant's
    value.

    ``draws`` [resamples] are its bootstrap draws; ``per_seed`` the same quantity from each seed
    alone, in seed order. Bounded outcomes have their ``scenes`` as well, and a score interval in
    place of the bootstrap's; for new seeds that of Student's t over ``per_seed`` stands beside it.
    What has none of these has no interval. ``pairs`` [scenes, seeds] are the differences of yes or
    no, not a number where a pair has not both outcomes.
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
    """Whether 0 is no difference; not so for rates, ratios and what is counted."""
    test: PairedTest | None = None
    """See `with_test`; without one the interval decides."""
    notable: float | None = None
    """Where a greater difference than this could have been missed, detecting none says nothing."""

    @property
    def won(self) -> tuple[tuple[int, int], ...] | None:
        """Return seed by seed in how many scenes only one of the variants succeeded."""
        if self.pairs is None:
            return None
        return tuple((int((c > 0).sum()), int((c < 0).sum())) for c in self.pairs.T)

    @property
    def ahead(self) -> tuple[int, int]:
        """In how many scenes the first was ahead over the seeds, and in how many the second."""
        values = np.zeros(0) if self.scenes is None else self.scenes.values
        return int((values > 0).sum()), int((values < 0).sum())

    @property
    def rounding(self) -> float:
        """Return the least variance of a seed's effect, of n scenes.

        A share of n scenes is known to 1 / n only, which keeps equal seeds from looking like
        certainty.
        """
        return (100.0 / self.n_scenes) ** 2 / 12.0 if self.unit == "pp" else 0.0

    def ends(self, level: float) -> tuple[float, float] | None:
        """Return the score interval, or where outcomes have no bound the percentile interval.

        For newly trained models it is the hull of the score interval and of that of the seeds'
        effects: the one speaks for what no scene showed, the other for how trainings differ.
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

    def resampled(self) -> "Contrast":
        """Return it with the percentile interval of its draws in the place of the score's.

        It is for comparing with what was reported so. Of few discordant scenes it is too narrow.
        """
        if self.scenes is None:
            return self
        return replace(self, scenes=None, method="percentile bootstrap of scenes")

    def estimate(self, level: float = 0.95) -> Estimate:
        """Return the value with its interval at ``level``, to be stored."""
        low, high = self.ends(level) or (None, None)
        resamples = self.resamples.n_resamples if self.resamples else 0
        return Estimate(
            value=self.value,
            low=low,
            high=high,
            level=level,
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
        """Return the side of 0 on which the whole interval lies; 0 when it touches 0."""
        low, high = self.interval or (0.0, 0.0)
        return 1 if low > 0 else -1 if high < 0 else 0

    @property
    def enough(self) -> bool:
        """Return whether there are scenes enough to decide anything."""
        return self.n_scenes >= MIN_SCENES

    @property
    def detected(self) -> Sign:
        """Return the side on which interval and test agree, at the level of this test alone.

        Without a test, that of the interval.
        """
        if self.test is None:
            return self.sign_of_interval if self.enough else 0
        return (
            self.sign_of_interval
            if self.test.rejects() and self.test.leans == self.sign_of_interval
            else 0
        )

    @property
    def sign(self) -> Sign:
        """Return the side that is decided in its family; 0 for neither."""
        return self.test.sign if self.test else 0

    @cached_property
    def least(self) -> float | None:
        """The least difference from 0 that would have been detected with 80 % power, in ``unit``.

        That of one contrast by itself, by the paper's test.

        None where no difference would, or where 0 is not what it is set against.
        """
        if self.pairs is not None:
            return detectable(self.pairs)
        if not (self.against_zero and self.enough and self.interval):
            return None
        half_width = normal_quantile(0.975)  # of a 95 % interval, in standard errors
        # What has no bound has a bootstrap interval, whose ends say less of its spread than draws.
        low, high = self.interval
        bounded = self.scenes is not None
        error = (high - low) / (2.0 * half_width) if bounded else float(self.draws.std())
        return (half_width + normal_quantile(0.8)) * error if error > ROUNDING else None


def percentile_interval(draws: Floats, level: float = 0.95) -> tuple[float, float]:
    """Return the central ``level`` percentile interval of ``draws`` [resamples].

    The upper end is taken as the mirrored lower end of the negated draws, so that swapping the
    variants mirrors the interval to the bit.
    """
    if not 0.0 < level < 1.0:
        raise ValueError(f"the level of an interval lies between 0 and 1, not at {level}")
    tail = (1.0 - level) / 2.0
    low = float(np.quantile(draws, tail))
    high = 0.0 - float(np.quantile(-draws, tail))
    return low + 0.0, high


def weighted_sum(weights: Sequence[float], contrasts: Sequence[Contrast]) -> Contrast:
    """Return a weighted sum of contrasts on the same scenes, scene by scene and draw by draw.

    ``ValueError`` for contrasts on other resamples, in other units or with another estimand.
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
    elif scenes.sequential:
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
        notable=None,
    )


def _dot(weights: Sequence[float], values: Sequence[float]) -> float:
    products = (w * v for w, v in zip(weights, values, strict=True))
    return round(ordered_sum(products), _DIGITS) + 0.0


def ordered_sum(values: Iterable[float]) -> float:
    """Add from left to right: from Python 3.12 on `sum` compensates, with other last bits."""
    return reduce(add, values, 0.0)


def change(before: Contrast, after: Contrast) -> Contrast:
    """Return how much a contrast changes, for example from reconstruction-only to shared."""
    return weighted_sum((-1.0, 1.0), (before, after))


def check_joint(one: Contrast, two: Contrast) -> None:
    """Refuse contrasts that cannot be combined scene by scene."""
    if one.resamples is None or two.resamples is None or not one.resamples.same_as(two.resamples):
        raise ValueError("effects are joint only on the same resamples; draw them once and share")
    if one.unit != two.unit:
        raise ValueError(f"effects in {one.unit!r} and {two.unit!r} cannot be combined")
    if one.estimand != two.estimand:
        raise ValueError("one effect speaks of new seeds and the other does not")
    if one.estimand == SCENES_AND_SEEDS and one.n_seeds != two.n_seeds:
        raise ValueError("effects that speak of new seeds need the same seeds")
