"""The expected difference where both errors are drawn together, and the break-even correlation.

Errors are Gaussian with the user's means and spreads. The expectation of the surface at a
correlation is a weighted sum of what was measured at the points, so it has the score test of every
other effect; correlations at which that does not reject 0 are a confidence set for the break-even
correlation (Fieller's idea, as for the break-even frequency). The critical value is that of all
correlations together, so that whatever is said of any of them holds at once.
"""

from collections.abc import Sequence
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np

from faultpath.analyses.map.lattice import SHOWN, UNITS, surface_weights
from faultpath.analyses.map.model import CorrelationRegion, Expectation, JointErrors, MapFacts
from faultpath.analyses.map.surface import Combined, Differences, sign_of, simultaneous
from faultpath.stats.breakeven import pieces_of
from faultpath.stats.distributions import normal_quantile
from faultpath.stats.inputs import Floats

_NODES = 96
"""Equally likely values of each of two independent errors, from which the joint ones are made."""
_GRID = np.linspace(-1.0, 1.0, 81)
_CURVE: list[float] = np.linspace(-1.0, 1.0, 41).tolist()


@cache
def _independent() -> tuple[Floats, Floats]:
    grid = (np.arange(_NODES) + 0.5) / _NODES
    one = np.array([normal_quantile(p) for p in grid.tolist()])
    one /= one.std()
    return np.tile(one, _NODES), np.repeat(one, _NODES)


class Errors(NamedTuple):
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


@lru_cache(maxsize=512)
def lattice_weights(errors: Errors, correlation: float) -> Floats:
    """Return `[lattice]` how the expectation follows from the surface on its lattice.

    Between the places of the lattice the surface is bilinear; an error beyond the map counts as one
    at its edge.
    """
    steps = 2 * UNITS // SHOWN
    drawn = errors.draw(correlation)
    x, y = ((np.clip(e, -1.0, 1.0) + 1.0) * steps / 2.0 for e in drawn)
    left, low = (
        np.minimum(np.floor(coordinates), steps - 1).astype(np.int64) for coordinates in (x, y)
    )
    totals = np.zeros((steps + 1) ** 2)
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        share = np.abs(1 - i - (x - left)) * np.abs(1 - j - (y - low))
        place = (low + j) * (steps + 1) + left + i
        totals += np.bincount(place, share, minlength=len(totals))
    totals /= len(x)
    totals.setflags(write=False)  # shared by all who ask
    return totals


def joint(
    facts: MapFacts, differences: Differences, correlation: float | None = None
) -> JointErrors:
    """Return the expected difference over all correlations and at one of them, and where it is
    decided."""
    (m1, m2), (s1, s2), largest = facts.means, facts.spreads, facts.up_to
    errors = Errors((m1 / largest, m2 / largest), (s1 / largest, s2 / largest))
    surface = surface_weights(differences.points)

    def weights(correlations: Sequence[float]) -> Floats:
        return np.stack([lattice_weights(errors, r) for r in correlations]) @ surface

    z = simultaneous(weights(_GRID.tolist()), differences, facts.library_hash)

    def at(correlations: Sequence[float]) -> Combined:
        return Combined.of(weights(correlations), differences)

    def expected(correlations: Sequence[float]) -> tuple[Expectation, ...]:
        every = at(correlations)
        columns = (every.means, *every.ends(z), every.signs(z, tested=False))
        return tuple(
            Expectation(
                correlation=r, value=float(value), low=float(a), high=float(b), sign=sign_of(sign)
            )
            for r, value, a, b, sign in zip(correlations, *columns, strict=True)
        )

    pieces = pieces_of(lambda r: at(r.tolist()).signs(z, tested=False) == 0, _GRID)
    edges = [-1.0, *(edge for piece in pieces for edge in piece), 1.0]
    spans = [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]
    means: list[float] = at([0.5 * (a + b) for a, b in spans]).means.tolist() if spans else []
    requested = {0.0, 1.0} if correlation is None else {0.0, 1.0, correlation}
    return JointErrors(
        curve=expected(_CURVE),
        requested=expected(sorted(requested)),
        estimates=_crossings(at(_GRID.tolist()).means),
        undecided=pieces,
        regions=tuple(
            CorrelationRegion(low=low, high=high, sign=sign_of(mean))
            for (low, high), mean in zip(spans, means, strict=True)
        ),
        outside=max(map(errors.outside, _CURVE)),
        critical=z,
    )


def _crossings(means: Floats) -> tuple[float, ...]:
    """Return where the estimate changes its sign, between the correlations looked at."""
    change = np.flatnonzero(means[:-1] * means[1:] < 0.0)
    exact = _GRID[1:-1][(means[1:-1] == 0.0) & (means[:-2] * means[2:] < 0.0)]
    share = means[change] / (means[change] - means[change + 1])
    between = _GRID[change] + share * (_GRID[change + 1] - _GRID[change])
    return tuple(sorted([*between.tolist(), *exact.tolist()]))
