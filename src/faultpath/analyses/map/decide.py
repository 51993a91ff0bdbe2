"""From the differences at the points of a map to its result.

The result includes the expected difference where both errors are drawn together, and the break-even
correlation. Errors are Gaussian with the user's means and spreads. The expectation of the surface
at a correlation is a weighted sum of what was measured at the points, so it has the score test of
every other effect. Correlations at which that does not reject 0 are a confidence set for the
break-even correlation (Fieller's idea, as for the break-even frequency). One critical value holds
for all correlations, so that statements about several of them hold together.
"""

from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np

from faultpath.analyses.map.lattice import (
    SHOWN,
    UNITS,
    Point,
    along,
    first_turn,
    rays,
    sizes,
    surface_weights,
)
from faultpath.analyses.map.model import (
    CorrelationRegion,
    Expectation,
    Flip,
    JointErrors,
    MapFacts,
    MapPoint,
    MapResult,
    MapSurface,
)
from faultpath.analyses.map.surface import Combined, Differences, Signs, simultaneous
from faultpath.analyses.model import invalid_by
from faultpath.run.findings import Finding
from faultpath.run.question import MapQuestion
from faultpath.stats.breakeven import pieces_of
from faultpath.stats.distributions import normal_quantile
from faultpath.stats.estimate import Sign, sign_of
from faultpath.stats.inputs import Floats

_NODES = 96
"""Equally likely values of each of two independent errors, from which the joint ones are made."""
_GRID = np.linspace(-1.0, 1.0, 81)
_CURVE: list[float] = np.linspace(-1.0, 1.0, 41).tolist()


def concluded(
    question: MapQuestion,
    facts: MapFacts,
    differences: Differences,
    failed: int = 0,
    findings: Sequence[Finding] = (),
) -> MapResult:
    """Return the result of differences, which may be simulated ones.

    Statements rest on the pairs of errors that were run: between them the surface is interpolated,
    and its bands leave out the error of that. Where `findings` say that no result follows, nothing
    is significant.
    """
    points, between = np.eye(len(differences.points)), surface_weights(differences.points)
    # One critical value for all places that are shown.
    z = simultaneous(np.concatenate([points, between]), differences, facts.library_hash)
    at, surface = Combined.of(points, differences), Combined.of(between, differences)
    invalid = invalid_by(findings)
    significant, shaded = (part.signs(z) * (invalid is None) for part in (at, surface))
    signs = dict(zip(differences.points, significant.tolist(), strict=True))
    side = 2 * UNITS // SHOWN + 1
    return MapResult(
        question=question,
        facts=facts,
        scenes=differences.values.shape[1],
        invalid=invalid,
        points=_points(facts, differences, at, significant, z),
        surface=MapSurface(
            sizes=tuple(facts.size(u) for u in range(-UNITS, UNITS + 1, SHOWN)),
            difference=tuple(tuple(map(float, row)) for row in surface.means.reshape(side, side)),
            sign=tuple(tuple(sign_of(v) for v in row) for row in shaded.reshape(side, side)),
        ),
        flips=tuple(
            _flip(condition, sign_of(direction), differences, way, signs, facts.up_to)
            for (condition, direction), way in rays(facts.modules).items()
        ),
        joint=joint(facts, differences, question.correlation),
        critical=z,
        failed=failed,
        findings=tuple(findings),
    )


def _points(
    facts: MapFacts, differences: Differences, at: Combined, signs: Signs, z: float
) -> tuple[MapPoint, ...]:
    low, high = at.ends(z)
    means = at.means
    return tuple(
        MapPoint(
            errors=(facts.size(x), facts.size(y)),
            baseline_percent=100.0 * float(differences.baseline[i].mean()),
            repair_percent=100.0 * float(differences.repair[i].mean()),
            difference=float(means[i]),
            low=float(low[i]),
            high=float(high[i]),
            sign=sign_of(signs[i]),
            won=int((differences.values[i] > 0).sum()),
            lost=int((differences.values[i] < 0).sum()),
        )
        for i, (x, y) in sorted(enumerate(differences.points), key=lambda item: item[1])
    )


def _flip(
    condition: str,
    direction: Sign,
    differences: Differences,
    way: Point,
    significant: Mapping[Point, int],
    up_to: float,
) -> Flip:
    """Return where the ranking turns along one way, by the sizes of the error that were run."""
    known = sizes(way, differences.points)
    signs = [significant[along(way, size)] for size in known]

    def until_other(begin: int) -> int:
        """Return the last of the sizes from `begin` on with the same sign."""
        end = begin
        while end + 1 < len(signs) and signs[end + 1] == signs[begin]:
            end += 1
        return end

    start = sign_of(signs[0])
    kept = until_other(0) if start else None
    first = next((i for i, sign in enumerate(signs) if sign and sign != start), None)
    last = None if first is None else until_other(first)
    means = [differences.mean(along(way, size)) for size in known]
    turn, crossing = first_turn(known, means), None
    if turn is not None:
        low, high = (means[known.index(size)] for size in turn)
        crossing = turn[0] + (turn[1] - turn[0]) * low / (low - high)
    places = (None if at is None else known[at] for at in (kept, first, last))
    until, begin, end, estimate = (
        None if size is None else round(size * direction * up_to / UNITS, 12)
        for size in (*places, crossing)
    )
    return Flip(
        condition=condition,
        direction=direction,
        start=start,
        turned=0 if first is None else sign_of(signs[first]),
        until=until,
        estimate=estimate,
        first=begin,
        last=end,
    )


def joint(
    facts: MapFacts, differences: Differences, correlation: float | None = None
) -> JointErrors:
    """Return the expected difference over all correlations and at one of them, and where it is
    significant."""
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

    signs, grid = at(_GRID.tolist()).signs(z, tested=False), _GRID
    if (signs[:-1] * signs[1:] < 0).any():  # what is undecided between them is narrower than that
        turns = pieces_of(lambda r: at(r.tolist()).means > 0.0, _GRID)
        grid = np.union1d(_GRID, turns)
    pieces = pieces_of(lambda r: at(r.tolist()).signs(z, tested=False) == 0, grid)
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
    """Return where the estimate changes its sign, between the correlations of the grid."""
    change = np.flatnonzero(means[:-1] * means[1:] < 0.0)
    exact = _GRID[1:-1][(means[1:-1] == 0.0) & (means[:-2] * means[2:] < 0.0)]
    share = means[change] / (means[change] - means[change + 1])
    between = _GRID[change] + share * (_GRID[change + 1] - _GRID[change])
    return tuple(sorted([*between.tolist(), *exact.tolist()]))


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
    totals.setflags(write=False)  # cached
    return totals


@cache
def _independent() -> tuple[Floats, Floats]:
    grid = (np.arange(_NODES) + 0.5) / _NODES
    one = np.array([normal_quantile(p) for p in grid.tolist()])
    one /= one.std()
    return np.tile(one, _NODES), np.repeat(one, _NODES)
