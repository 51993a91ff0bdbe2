"""Significance on the map, with one critical value, and which points come next.

Every number is a weighted sum of the differences that scenes show at the sampled points, so scenes
stay the sample, and points of the map depend on each other as these differences do.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from faultpath.analyses.map.lattice import (
    COARSE,
    FINE,
    Point,
    along,
    corners,
    cut,
    first_turn,
    lattice,
    rays,
    sizes,
)
from faultpath.stats.distributions import binomial_cdf, normal_tails
from faultpath.stats.inputs import Floats
from faultpath.stats.power import MIN_SCENES
from faultpath.stats.resamples import ROUNDING, Resamples
from faultpath.stats.score import SceneValues, interval, quantile, rejects

Signs = NDArray[np.int64]
RESAMPLES = 2000
_DIGITS = 9
"""Digits of a combined value, so that values which cancel leave exactly 0."""


@dataclass(frozen=True, eq=False)
class Differences:
    """Success of the repair and of the baseline, `[points, scenes, seeds]`, at `points`."""

    points: tuple[Point, ...]
    repair: Floats = field(repr=False)
    baseline: Floats = field(repr=False)

    @cached_property
    def values(self) -> Floats:
        """Repair minus baseline `[points, scenes]`, in percentage points, over the seeds."""
        seeds = self.repair.shape[2]
        return 100.0 * (self.repair - self.baseline).sum(axis=2) / seeds

    @cached_property
    def far(self) -> Floats:
        """How far from 0 a scene may lie that was not observed `[points]`, percentage points."""
        return np.array(
            [
                SceneValues.paired(row / 100.0, 1.0, test="conditional").far * 100.0
                for row in self.values
            ]
        )

    def mean(self, point: Point) -> float:
        """Return the mean difference at a point."""
        return float(self.values[self.points.index(point)].mean())


@dataclass(frozen=True, eq=False)
class Combined:
    """Weighted sums of the differences, one a spot: `values [spots, scenes]`, `far [spots]`."""

    values: Floats
    far: Floats

    @classmethod
    def of(cls, weights: Floats, differences: Differences) -> "Combined":
        """Return the sums with `weights [spots, points]`."""
        values: Floats = np.sort((weights @ differences.values).round(_DIGITS), axis=1)
        return cls(values, np.abs(weights) @ differences.far)

    @property
    def means(self) -> Floats:
        """The estimates `[spots]`."""
        return self.values.mean(axis=1).round(_DIGITS) + 0.0

    def ends(self, z: float) -> tuple[Floats, Floats]:
        """Return both ends `[spots]` of the score interval with the critical value `z`."""
        low, high = interval(self.values, np.ones_like(self.values), self.far, z)
        return low + 0.0, high + 0.0

    def signs(self, z: float, tested: bool = True) -> Signs:
        """Return `[spots]` the side of 0 that is significantly ahead, 0 for neither.

        The score test has to reject at `z`; where `tested` the sign test of the scenes at the same
        level, and on the same side, as well. With fewer than `MIN_SCENES` nothing is significant.
        """
        if self.values.shape[1] < MIN_SCENES:
            return np.zeros(len(self.values), dtype=np.int64)
        beyond = rejects(self.values, np.ones_like(self.values), 0.0, self.far, z)
        signs = np.sign(self.means).astype(np.int64) * beyond
        if not tested:
            return signs
        first, second = (self.values > 0).sum(axis=1), (self.values < 0).sum(axis=1)
        p = 2.0 * binomial_cdf(np.minimum(first, second), first + second, 0.5)
        return signs * (np.sign(first - second) * (p <= normal_tails(z)) == signs)


def simultaneous(weights: Floats, differences: Differences, label: str) -> float:
    """Return the critical value of all spots together, `weights [spots, points]`.

    Scenes are resampled over the whole map at once: 95 % of the resamples deviate nowhere by more
    standard errors than this. It is never below that of one spot alone.
    """
    values = (weights @ differences.values).round(_DIGITS)
    spread = values.std(axis=1)
    # Where fewer scenes differ nothing can be significant, and one scene makes a great step.
    resampled = (spread > ROUNDING) & ((values != 0.0).sum(axis=1) >= MIN_SCENES)
    one = quantile(0.95)
    if not resampled.any():
        return one
    n_scenes = values.shape[1]
    resamples = _resamples(label, n_scenes)
    errors = spread[resampled] * np.sqrt(n_scenes)
    centred = values[resampled] - values[resampled].mean(axis=1, keepdims=True)
    studentised = (centred / errors[:, np.newaxis]).T
    largest = [np.abs(block @ studentised).max(axis=1) for block in resamples.blocks()]
    return max(one, float(np.quantile(np.concatenate(largest), 0.95)))


@lru_cache(maxsize=4)
def _resamples(label: str, scenes: int) -> Resamples:
    return Resamples.draw(f"map/{label}", scenes, n_resamples=RESAMPLES)


def next_points(
    differences: Differences, modules: Sequence[str], limit: int, label: str
) -> tuple[Point, ...]:
    """Return the points to add, none when the map is done: same data, same points.

    First cells are cut in which no side is significantly ahead, the largest cells first, until
    there are `limit` points or cells of the least size. Then, under each condition of the fault,
    the first change of the estimate's sign is bisected down to one unit.
    """
    every = np.eye(len(differences.points))
    significant = Combined.of(every, differences).signs(simultaneous(every, differences, label))
    signs = dict(zip(differences.points, significant.tolist(), strict=True))
    means = dict(zip(differences.points, differences.values.mean(axis=1).tolist(), strict=True))

    def urgency(cell: Point) -> tuple[bool, float, Point]:
        values = [means[corner] for corner in corners(cell, spacing)]
        return min(values) * max(values) >= 0.0, abs(sum(values)), cell

    spacing, new = COARSE, dict[Point, None]()
    while spacing > FINE and not new:
        whole = [c for c in lattice(spacing) if all(e in signs for e in corners(c, spacing))]
        cells = [c for c in whole if {signs[e] for e in corners(c, spacing)} not in ({1}, {-1})]
        for cell in sorted(cells, key=urgency):
            added = [point for point in cut(cell, spacing) if point not in signs]
            if len(signs) + len({*new, *added}) <= limit:
                new.update(dict.fromkeys(added))
        spacing //= 2
    if new:
        return tuple(sorted(new))
    for direction in rays(modules).values():
        known = sizes(direction, differences.points)
        turn = first_turn(known, [differences.mean(along(direction, size)) for size in known])
        if turn is not None and turn[1] - turn[0] > 1:
            new[along(direction, sum(turn) // 2)] = None
    return tuple(new)
