"""The score test of a mean of bounded scene values, and the interval that inverts it.

Scenes are the sample; each has one value between ``-bound`` and ``bound``. Under the null that the
mean is ``d``, the most likely distribution with that mean puts ``w = 1 / (n (1 + a (y - d)))`` on
every observed value ``y``, and the rest of its mass on one end of the support, observed or not. The
multiplier ``a`` follows from the mean. With the variance ``V`` of that distribution
``z^2 = n (mean - d)^2 / V``, which is ``n a (mean - d)``.

For one seed of binary outcomes this is Tango's score test (Statistics in Medicine 17:891, 1998):
the values are -1, 0 and 1, and ``V`` is his restricted estimate. For several seeds the values are
means over the seeds of a scene, so that seeds may depend on each other in any way. No interval has
width zero, because a value that was not observed in n scenes may still exist.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from faultpath.stats import betting, unconditional
from faultpath.stats.distributions import normal_quantile, normal_tails
from faultpath.stats.estimate import TestKind
from faultpath.stats.inputs import Floats

_HALVINGS = 44
_DIGITS = 9
"""Digits of a combined value, so that values which cancel leave exactly 0."""
PRIOR = 3.0
"""Scenes of the largest possible difference that `reach` adds."""


@dataclass(frozen=True, eq=False)
class SceneValues:
    """One value a scene, ``values`` [scenes], at most ``bound`` from 0.

    ``far`` is the assumed largest distance from 0 of values that were not observed. The unit of the
    effect is reached by ``scale * (value + centre)``.
    """

    values: Floats = field(repr=False)
    bound: float
    far: float
    scale: float = 1.0
    centre: float = 0.0
    test: TestKind = "conditional"
    """Test with which the interval agrees: the unconditional one excludes 0 only where
    `degrees_p_value` is small, the sequential one is a confidence sequence (`betting`)."""

    @classmethod
    def paired(
        cls,
        values: Floats,
        bound: float,
        scale: float = 1.0,
        test: TestKind = "unconditional",
    ) -> "SceneValues":
        """Return differences between two variants.

        Unobserved differences may lie anywhere within the bound; for the conditional test, whose
        interval stands alone, within `reach`.
        """
        scenes = cls(values, bound, bound, scale, test=test)
        if test != "conditional":
            return scenes
        kinds, counts = scenes.kinds
        # In both orders, since swapping the variants reverses the order of the sum.
        orders = ((kinds, counts), (kinds[::-1], counts[::-1]))
        return replace(scenes, far=float(max(reach(*pair, bound) for pair in orders)))

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Return the interval of the mean, in the unit of the effect."""
        ends = self.ends(*self.kinds, np.asarray(self.far), self.bound, level)
        low, high = (self.scale * (float(end) + self.centre) for end in ends)
        return low + 0.0, high + 0.0  # never -0.0

    def ends(
        self, values: Floats, counts: Floats, far: Floats, bound: Floats | float, level: float
    ) -> tuple[Floats, Floats]:
        """Return both ends [...] of the interval of other values, by this object's test."""
        if self.test == "sequential":
            return betting.interval(values, counts, far, level)
        if self.test == "unconditional":
            return degrees_interval(values, counts, bound, level)
        return interval(values, counts, far, quantile(level))

    @cached_property
    def kinds(self) -> tuple[Floats, Floats]:
        """The distinct values, ascending, and how often each occurred."""
        values, counts = np.unique(self.values, return_counts=True)
        return values, counts.astype(np.float64)


def combined(weights: Sequence[float], parts: Sequence[SceneValues]) -> SceneValues:
    """Return the weighted sum of paired values of one scale, scene by scene."""
    values: Floats = np.dot(weights, np.stack([part.values for part in parts])).round(_DIGITS)
    size = np.abs(np.array(weights))
    bound = float(size @ np.array([part.bound for part in parts]))
    far = float(size @ np.array([part.far for part in parts]))
    return replace(parts[0], values=values, bound=bound, far=far)


def quantile(level: float) -> float:
    """Return the ``z`` of a central interval at ``level``."""
    if not 0.0 < level < 1.0:
        raise ValueError(f"the level of an interval lies between 0 and 1, not at {level}")
    return normal_quantile((1.0 + level) / 2.0)


def reach(values: Floats, counts: Floats, bound: Floats | float) -> Floats:
    """Return [...]: the assumed largest distance from 0 of values that were not observed.

    ``values`` and ``counts`` are [..., values]. With one seed a scene differs wholly or not, and
    this is ``bound``. With several it is closer to the observed sizes, never below the largest: the
    mean size, each scene weighted by its size, with `PRIOR` scenes of the largest possible size
    added.
    """
    size = np.abs(values)
    total = (counts * size).sum(axis=-1)
    squares = (counts * size * size).sum(axis=-1)
    shrunk = (squares + PRIOR * np.square(bound)) / (total + PRIOR * np.asarray(bound))
    largest = np.where(counts > 0, size, 0.0).max(axis=-1)
    return np.asarray(np.clip(shrunk, largest, bound), dtype=np.float64)


def degrees_p_value(values: Floats, counts: Floats, bound: float) -> float:
    """Return the two-sided p of "the mean is 0" for scenes that differ by degrees.

    It is the larger of two: the score's, for which an unobserved difference may be a whole one, and
    E+M's (`unconditional`) for an effective number of wholly discordant scenes,
    ``(sum |y|)^2 / sum y^2``, at ``z = sum y / sqrt(sum y^2)``. If scenes differ wholly or not at
    all, these are the E+M test's own numbers.
    """
    if counts @ values < 0.0:  # one order of sums for both variants
        values, counts = -values[::-1].copy(), counts[::-1].copy()
    z, discordants = map(float, _degrees(values, counts))
    p = unconditional.degrees_p_value(z, discordants, round(counts.sum()))
    return max(p, p_value(values, counts, bound))


def degrees_rejects(
    values: Floats, counts: Floats, bound: Floats | float, alpha: float
) -> NDArray[np.bool_]:
    """Return [...]: whether that p is at most ``alpha``; all samples have as many scenes."""
    z, discordants = _degrees(values, counts)
    rejected = rejects(values, counts, 0.0, bound, quantile(1.0 - alpha))
    n_scenes = round(float(counts.sum(axis=-1).max()))
    rejected[rejected] = unconditional.degrees_rejects(
        z[rejected], discordants[rejected], n_scenes, alpha
    )
    return rejected


def degrees_interval(
    values: Floats, counts: Floats, bound: Floats | float, level: float
) -> tuple[Floats, Floats]:
    """Return both ends [...] of `interval`, widened to hold 0 where `degrees_rejects` does not."""
    rejected = degrees_rejects(values, counts, bound, 1.0 - level)
    low, high = interval(values, counts, np.asarray(bound, dtype=np.float64), quantile(level))
    return (
        np.where(rejected, low, np.minimum(low, 0.0)),
        np.where(rejected, high, np.maximum(high, 0.0)),
    )


def _degrees(values: Floats, counts: Floats) -> tuple[Floats, Floats]:
    """Return [...]: z of scenes that differ by degrees, and their effective discordants."""
    total, sizes, squares = (  # in both orders, since swapping the variants reverses the sum
        0.5 * ((counts * y).sum(axis=-1) + (counts * y)[..., ::-1].copy().sum(axis=-1))
        for y in (values, np.abs(values), np.square(values))
    )
    squares = np.where(squares > 0.0, squares, 1.0)
    return np.abs(total) / np.sqrt(squares), np.square(sizes) / squares


def rejects(
    values: Floats, counts: Floats, null: Floats | float, far: Floats | float, z: float
) -> NDArray[np.bool_]:
    """Return [...]: whether the score of "the mean is ``null``" exceeds ``z`` on either side.

    ``counts`` [..., values] says how often each of ``values`` occurred; ``far`` [...] is the
    support's end on either side of 0. It evaluates each sample once, so it suits simulations.
    """
    total = counts.sum(axis=-1)
    share = counts / total[..., np.newaxis]
    residual = values - np.asarray(null, dtype=np.float64)[..., np.newaxis]
    mean = (share * residual).sum(axis=-1)
    side = np.where(mean < 0.0, -1.0, 1.0)
    observed_end = np.where(counts > 0, -side[..., np.newaxis] * values, -np.inf).max(axis=-1)
    far = np.maximum(far, observed_end)
    # z^2 = n a |mean| exceeds its level if `a` exceeds `multiplier`. The support's end limits `a`.
    feasible = np.abs(mean) > z * z / total * (far + side * null)
    multiplier = np.zeros_like(mean)
    np.divide(z * z / total, np.abs(mean), out=multiplier, where=feasible)
    residual = np.where(counts > 0, side[..., np.newaxis] * residual, 0.0)
    weighted = share * residual / (1.0 + multiplier[..., np.newaxis] * residual)
    exceeded = weighted.sum(axis=-1) > 0.0
    return np.asarray(feasible & exceeded, dtype=np.bool_)


def p_value(values: Floats, counts: Floats, far: float) -> float:
    """Return the least ``alpha`` at which the score rejects "the mean is 0", two-sided.

    ``z^2 = n a |mean|`` for the greatest ``a`` that the most likely distribution may have.
    """
    total = float(counts.sum())
    mean = float(counts @ values) / total
    residual = values if mean > 0.0 else -values
    low, high = 0.0, 1.0 / max(far, -float(residual.min()))
    for _ in range(_HALVINGS + 8):
        multiplier = 0.5 * (low + high)
        larger = float((counts * residual / (1.0 + multiplier * residual)).sum()) > 0.0
        low, high = (multiplier, high) if larger else (low, multiplier)
    return float(normal_tails(np.sqrt(total * low * abs(mean))))


def interval(values: Floats, counts: Floats, far: Floats, z: float) -> tuple[Floats, Floats]:
    """Return both ends [...] of the means that `rejects` does not reject.

    The upper end is the mirrored lower end of the negated values: with ascending ``values``,
    swapping the variants mirrors the interval to the bit.
    """
    mirrored = _low(-values[..., ::-1], counts[..., ::-1], far, z)
    return _low(values, counts, far, z), 0.0 - mirrored


def _low(values: Floats, counts: Floats, far: Floats, z: float) -> Floats:
    """Return the lower end: the mean less the ``m`` at which ``n a m = z^2``.

    With ``a = z^2 / (n m)`` the equation that defines ``a`` rises in ``m``, which is bisected.
    """
    total = counts.sum(axis=-1)
    share = counts / total[..., np.newaxis]
    level = z * z / total
    mean = (share * values).sum(axis=-1)
    residual = np.where(counts > 0, values - mean[..., np.newaxis], 0.0)
    far = np.maximum(far, -np.where(counts > 0, values, np.inf).min(axis=-1))
    # The support's end limits `a`, hence the width from below.
    short: Floats = np.asarray(level * (far + mean) / (1.0 + level), dtype=np.float64)
    long: Floats = np.maximum(short, -residual.min(axis=-1))
    for _ in range(_HALVINGS):
        middle = 0.5 * (short + long)
        weight = ((1.0 + level) * middle)[..., np.newaxis] + level[..., np.newaxis] * residual
        term: Floats = np.zeros_like(weight)
        np.divide(share * (residual + middle[..., np.newaxis]), weight, out=term, where=weight > 0)
        wider: NDArray[np.bool_] = term.sum(axis=-1) < 0.0
        short, long = np.where(wider, middle, short), np.where(wider, long, middle)
    return np.asarray(mean - long, dtype=np.float64)
