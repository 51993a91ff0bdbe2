"""The score test of a mean of bounded scene values, and the interval that inverts it.

Scenes are the sample; each has one value between ``-bound`` and ``bound``. Under the null that the
mean is ``d``, the most likely distribution with that mean puts ``w = 1 / (n (1 + a (y - d)))`` on
every observed value ``y``, and what is left over on one end of the support, observed or not. With
the variance ``V`` of that distribution ``z^2 = n (mean - d)^2 / V``, which is ``n a (mean - d)``.

For one seed of binary outcomes this is Tango's score test (Statistics in Medicine 17:891, 1998):
the values are -1, 0 and 1, and ``V`` is his restricted estimate. For several seeds the values are
means over the seeds of a scene, so that seeds may depend on each other in any way. No interval has
width zero, because what was not observed in n scenes may still exist.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from faultpath.stats import betting, unconditional
from faultpath.stats.distributions import normal_p_value, normal_quantile
from faultpath.stats.inputs import Floats

_HALVINGS = 44
_DIGITS = 9
"""Digits of a combined value, so that values which cancel leave exactly 0."""
PRIOR = 3.0
"""Scenes of the largest possible difference that `reach` adds."""


@dataclass(frozen=True, eq=False)
class SceneValues:
    """One value a scene, ``values`` [scenes], none further from 0 than ``bound``.

    ``far`` is how far from 0 a value is taken to lie that was not observed. ``scale`` and
    ``centre`` lead to the unit of the effect: ``scale * (value + centre)``.
    """

    values: Floats = field(repr=False)
    bound: float
    far: float
    scale: float = 1.0
    centre: float = 0.0
    sequential: bool = False
    """Whether the number of scenes was not fixed beforehand: see `betting`."""
    graded: bool = False
    """Whether the interval leaves out 0 exactly where `degrees_p_value` is small."""

    @classmethod
    def paired(
        cls,
        values: Floats,
        bound: float,
        scale: float = 1.0,
        sequential: bool = False,
        graded: bool = False,
    ) -> "SceneValues":
        """Return differences between two variants.

        A difference that was not observed may lie anywhere within the bound where the test of
        degrees is taken or the audit was ``sequential``, and else within `reach`.
        """
        if sequential or graded:
            return cls(values, bound, bound, scale, sequential=sequential, graded=not sequential)
        scenes = cls(values, bound, bound, scale)
        kinds, often = scenes.kinds()
        # Summed in both orders, since swapping the variants turns the order round.
        orders = ((kinds, often), (kinds[::-1], often[::-1]))
        return replace(scenes, far=float(max(reach(*pair, bound) for pair in orders)))

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Return the interval of the mean, in the unit of the effect: by score, or by betting."""
        ends = self.ends(*self.kinds(), np.asarray(self.far), self.bound, level)
        low, high = (self.scale * (float(end) + self.centre) for end in ends)
        return low + 0.0, high + 0.0  # never -0.0

    def ends(
        self, values: Floats, counts: Floats, far: Floats, bound: Floats | float, level: float
    ) -> tuple[Floats, Floats]:
        """Return both ends [...] of the interval of such scenes as these, with other values."""
        if self.sequential:
            return betting.interval(values, counts, far, level)
        if self.graded:
            return degrees_interval(values, counts, bound, level)
        return interval(values, counts, far, quantile(level))

    def kinds(self) -> tuple[Floats, Floats]:
        """Return the different values, ascending, and how often each occurred."""
        return self._kinds

    @cached_property
    def _kinds(self) -> tuple[Floats, Floats]:
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
    """Return [...]: how far from 0 a value that was not observed is taken to lie.

    ``values`` and ``counts`` are [..., values]. With one seed a scene differs wholly or not, and
    this is ``bound``. With several it lies nearer to the size of the differing scenes that were
    seen, never below the largest of them: the mean size, each scene weighted by its size, after
    `PRIOR` scenes of the largest possible size.
    """
    size = np.abs(values)
    seen = (counts * size).sum(axis=-1)
    squares = (counts * size * size).sum(axis=-1)
    shrunk = (squares + PRIOR * np.square(bound)) / (seen + PRIOR * np.asarray(bound))
    largest = np.where(counts > 0, size, 0.0).max(axis=-1)
    return np.asarray(np.clip(shrunk, largest, bound), dtype=np.float64)


def degrees_p_value(values: Floats, counts: Floats, bound: float) -> float:
    """Return the two-sided p of "the mean is 0" for scenes that differ by degrees.

    It is the larger of the score's, for which a difference that was not seen may be a whole one,
    and of E+M's (`unconditional`) for as many scenes as would tell as much if they differed wholly:
    ``(sum |y|)^2 / sum y^2``, at ``z = sum y / sqrt(sum y^2)``. Of scenes that differ wholly or not
    at all these are its own numbers.
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
    beyond = rejects(values, counts, 0.0, bound, quantile(1.0 - alpha))
    most = round(float(counts.sum(axis=-1).max()))
    beyond[beyond] = unconditional.degrees_rejects(z[beyond], discordants[beyond], most, alpha)
    return beyond


def degrees_interval(
    values: Floats, counts: Floats, bound: Floats | float, level: float
) -> tuple[Floats, Floats]:
    """Return both ends [...] of `interval`, which leaves out 0 only where the test does."""
    beyond = degrees_rejects(values, counts, bound, 1.0 - level)
    low, high = interval(values, counts, np.asarray(bound, dtype=np.float64), quantile(level))
    return np.where(beyond, low, np.minimum(low, 0.0)), np.where(
        beyond, high, np.maximum(high, 0.0)
    )


def _degrees(values: Floats, counts: Floats) -> tuple[Floats, Floats]:
    """Return [...]: z of scenes that differ by degrees, and how many whole ones they are worth."""
    total, sizes, squares = (  # in both orders, since swapping the variants turns the order round
        0.5 * ((counts * y).sum(axis=-1) + (counts * y)[..., ::-1].copy().sum(axis=-1))
        for y in (values, np.abs(values), np.square(values))
    )
    squares = np.where(squares > 0.0, squares, 1.0)
    return np.abs(total) / np.sqrt(squares), np.square(sizes) / squares


def rejects(
    values: Floats, counts: Floats, null: Floats | float, far: Floats | float, z: float
) -> NDArray[np.bool_]:
    """Return [...]: whether the score of "the mean is ``null``" is beyond ``z`` on either side.

    ``counts`` [..., values] says how often each of ``values`` occurred; ``far`` [...] is the
    support's reach on either side of 0. One look a sample, so fit for simulations.
    """
    total = counts.sum(axis=-1)
    share = counts / total[..., np.newaxis]
    off = values - np.asarray(null, dtype=np.float64)[..., np.newaxis]
    mean = (share * off).sum(axis=-1)
    side = np.where(mean < 0.0, -1.0, 1.0)
    lost = np.where(counts > 0, -side[..., np.newaxis] * values, -np.inf).max(axis=-1)
    far = np.maximum(far, lost)
    # z^2 = n a |mean| exceeds its level when `a` exceeds `tilt`; the support's end limits `a`.
    beyond = np.abs(mean) > z * z / total * (far + side * null)
    tilt = np.zeros_like(mean)
    np.divide(z * z / total, np.abs(mean), out=tilt, where=beyond)
    off = np.where(counts > 0, side[..., np.newaxis] * off, 0.0)
    inside = (share * off / (1.0 + tilt[..., np.newaxis] * off)).sum(axis=-1) > 0.0
    return np.asarray(beyond & inside, dtype=np.bool_)


def p_value(values: Floats, counts: Floats, far: float) -> float:
    """Return the least ``alpha`` at which the score rejects "the mean is 0", two-sided.

    ``z^2 = n a |mean|`` for the greatest ``a`` that the most likely distribution may have.
    """
    total = float(counts.sum())
    mean = float(counts @ values) / total
    off = values if mean > 0.0 else -values
    low, high = 0.0, 1.0 / max(far, -float(off.min()))
    for _ in range(_HALVINGS + 8):
        tilt = 0.5 * (low + high)
        further = float((counts * off / (1.0 + tilt * off)).sum()) > 0.0
        low, high = (tilt, high) if further else (low, tilt)
    return normal_p_value(float(np.sqrt(total * low * abs(mean))))


def interval(values: Floats, counts: Floats, far: Floats, z: float) -> tuple[Floats, Floats]:
    """Return both ends [...]: between them lie the means that `rejects` does not reject.

    The upper end is the mirrored lower end of the negated values: with ascending ``values``,
    swapping the variants mirrors the interval to the bit.
    """
    mirrored = _low(-values[..., ::-1], counts[..., ::-1], far, z)
    return _low(values, counts, far, z), 0.0 - mirrored


def _low(values: Floats, counts: Floats, far: Floats, z: float) -> Floats:
    """Return the lower end: the mean less the ``m`` at which ``n a m = z^2``.

    Put ``a = z^2 / (n m)`` into the equation that defines ``a``; what is left rises in ``m``.
    """
    total = counts.sum(axis=-1)
    share = counts / total[..., np.newaxis]
    level = z * z / total
    mean = (share * values).sum(axis=-1)
    off = np.where(counts > 0, values - mean[..., np.newaxis], 0.0)
    far = np.maximum(far, -np.where(counts > 0, values, np.inf).min(axis=-1))
    # The support's end limits `a`, hence the width from below.
    short: Floats = np.asarray(level * (far + mean) / (1.0 + level), dtype=np.float64)
    long: Floats = np.maximum(short, -off.min(axis=-1))
    for _ in range(_HALVINGS):
        middle = 0.5 * (short + long)
        weight = ((1.0 + level) * middle)[..., np.newaxis] + level[..., np.newaxis] * off
        term: Floats = np.zeros_like(weight)
        np.divide(share * (off + middle[..., np.newaxis]), weight, out=term, where=weight > 0)
        further: NDArray[np.bool_] = term.sum(axis=-1) < 0.0
        short, long = np.where(further, middle, short), np.where(further, long, middle)
    return np.asarray(mean - long, dtype=np.float64)
