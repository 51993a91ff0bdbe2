"""The expected difference where both errors are drawn together, and the break-even correlation.

Errors are Gaussian with the user's means and spreads. The expectation of the surface at a
correlation is a weighted sum of what was measured at the points, so it has the score test of every
other effect; correlations at which that does not reject 0 are a confidence set for the break-even
correlation (Fieller's idea, as for the break-even frequency). The critical value is that of all
correlations together, so that whatever is said of any of them holds at once.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from faultpath.decisions.map.lattice import SHOWN, UNITS, surface_weights
from faultpath.decisions.map.surface import Combined, Differences, simultaneous
from faultpath.statistics.breakeven import pieces_of
from faultpath.statistics.distributions import normal_quantile
from faultpath.statistics.inputs import Floats

_NODES = 96
"""Equally likely values of each of two independent errors, from which the joint ones are made."""
_GRID = np.linspace(-1.0, 1.0, 81)


@cache
def _independent() -> tuple[Floats, Floats]:
    grid = (np.arange(_NODES) + 0.5) / _NODES
    one = np.array([normal_quantile(p) for p in grid.tolist()])
    one /= one.std()
    return np.tile(one, _NODES), np.repeat(one, _NODES)


@dataclass(frozen=True)
class Errors:
    """A Gaussian joint distribution of the two errors, but for its correlation.

    `means` and `spreads` (standard deviations) are in units of the largest error of the map.
    """

    means: tuple[float, float]
    spreads: tuple[float, float]

    def draw(self, correlation: float) -> tuple[Floats, Floats]:
        """Return equally likely pairs of errors, each `[pairs]`.

        Both modules' errors are made alike from two independent ones, `sin(2 a)` being the
        correlation, so that exchanging the modules exchanges the errors.
        """
        u, v = _independent()
        angle = 0.5 * np.arcsin(np.clip(correlation, -1.0, 1.0))
        c, s = np.cos(angle), np.sin(angle)
        (m1, m2), (s1, s2) = self.means, self.spreads
        return m1 + s1 * (c * u + s * v), m2 + s2 * (s * u + c * v)

    def outside(self, correlation: float) -> float:
        """Return the share of pairs of which an error lies beyond the map."""
        x, y = self.draw(correlation)
        return float((np.maximum(np.abs(x), np.abs(y)) > 1.0).mean())

    def weights(self, correlation: float) -> Floats:
        """Return `[lattice]` how the expectation follows from the surface on its lattice.

        Between the places of the lattice the surface is bilinear; an error beyond the map counts
        as one at its edge.
        """
        return _weights(self, correlation)


@lru_cache(maxsize=512)
def _weights(errors: Errors, correlation: float) -> Floats:
    steps = 2 * UNITS // SHOWN
    drawn = errors.draw(correlation)
    x, y = ((np.clip(e, -1.0, 1.0) + 1.0) * steps / 2.0 for e in drawn)
    left, low = (np.minimum(np.floor(each), steps - 1).astype(np.int64) for each in (x, y))
    found = np.zeros((steps + 1) ** 2)
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        share = np.abs(1 - i - (x - left)) * np.abs(1 - j - (y - low))
        place = (low + j) * (steps + 1) + left + i
        found += np.bincount(place, share, minlength=len(found))
    found /= len(x)
    found.setflags(write=False)  # shared by all who ask
    return found


@dataclass(frozen=True, eq=False)
class Expected:
    """What is known of the expected difference over all correlations."""

    errors: Errors
    found: Differences
    label: str
    surface: Floats = field(repr=False)
    z: float

    @classmethod
    def over(cls, errors: Errors, found: Differences, label: str) -> "Expected":
        """Return it for the errors of a user and the points of a map."""
        surface = surface_weights(found.points)
        every = np.stack([errors.weights(r) for r in _GRID.tolist()]) @ surface
        return cls(errors, found, label, surface, simultaneous(every, found, label))

    def at(self, correlations: Sequence[float]) -> Combined:
        """Return the expected differences at correlations."""
        weights = np.stack([self.errors.weights(r) for r in correlations])
        return Combined.of(weights @ self.surface, self.found)

    def undecided(self, correlations: Floats) -> NDArray[np.bool_]:
        """Return `[correlations]` whether the difference at each is not told from 0."""
        return self.at(correlations.tolist()).signs(self.z, tested=False) == 0

    def pieces(self) -> tuple[tuple[float, float], ...]:
        """Return the correlations at which nobody is decided to be ahead, as intervals."""
        return pieces_of(self.undecided, _GRID)

    def crossings(self) -> tuple[float, ...]:
        """Return where the estimate changes its sign, between the correlations looked at."""
        means = self.at(_GRID.tolist()).means
        change = np.flatnonzero(means[:-1] * means[1:] < 0.0)
        exact = _GRID[1:-1][(means[1:-1] == 0.0) & (means[:-2] * means[2:] < 0.0)]
        share = means[change] / (means[change] - means[change + 1])
        between = _GRID[change] + share * (_GRID[change + 1] - _GRID[change])
        return tuple(sorted([*between.tolist(), *exact.tolist()]))
