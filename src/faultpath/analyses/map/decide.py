"""From the differences at the points of a map to its record."""

from collections.abc import Mapping, Sequence

import numpy as np

from faultpath.analyses.map.joint import joint
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
from faultpath.analyses.map.model import Flip, MapFacts, MapPoint, MapResult, MapSurface
from faultpath.analyses.map.surface import (
    Combined,
    Differences,
    Signs,
    sign_of,
    simultaneous,
)
from faultpath.analyses.model import invalid_by
from faultpath.run.findings import Finding
from faultpath.run.question import MapQuestion
from faultpath.stats.estimate import Sign


def decided(
    question: MapQuestion,
    facts: MapFacts,
    differences: Differences,
    failed: int = 0,
    findings: Sequence[Finding] = (),
) -> MapResult:
    """Return the record of differences, which may be simulated ones.

    What is said rests on the pairs of errors that were run alone: between them the surface is
    interpolated, and its bands leave out the error of that. Where `findings` say that no result
    follows, nothing is significant.
    """
    points, between = np.eye(len(differences.points)), surface_weights(differences.points)
    # One critical value for all places that are shown.
    z = simultaneous(np.concatenate([points, between]), differences, facts.library_hash)
    at, surface = Combined.of(points, differences), Combined.of(between, differences)
    invalid = invalid_by(findings)
    decided, shaded = (part.signs(z) * (invalid is None) for part in (at, surface))
    signs = dict(zip(differences.points, decided.tolist(), strict=True))
    side = 2 * UNITS // SHOWN + 1
    return MapResult(
        question=question,
        facts=facts,
        scenes=differences.values.shape[1],
        invalid=invalid,
        points=_points(facts, differences, at, decided, z),
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
    decided: Mapping[Point, int],
    up_to: float,
) -> Flip:
    """Return what the sizes of an error that were run along one way say of it."""
    known = sizes(way, differences.points)
    signs = [decided[along(way, size)] for size in known]

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
