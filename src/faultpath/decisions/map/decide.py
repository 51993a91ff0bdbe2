"""From the differences at the points of a map to its record."""

from collections.abc import Sequence

import numpy as np

from faultpath.decisions.map.joint import joint
from faultpath.decisions.map.lattice import (
    SHOWN,
    UNITS,
    Point,
    along,
    first_turn,
    rays,
    sizes,
    surface_weights,
)
from faultpath.decisions.map.model import Flip, MapPoint, MapRecord, MapSurface, ResolvedMap
from faultpath.decisions.map.surface import Combined, Differences, sign_of, simultaneous
from faultpath.decisions.sentences import maps
from faultpath.statistics.estimate import Sign
from faultpath.statistics.inputs import Floats

_BETWEEN = 4
"""Looks at a ray for each unit."""


def decided(
    question: ResolvedMap, differences: Differences, failed: int = 0, findings: Sequence[str] = ()
) -> MapRecord:
    """Return the record of differences, which may be simulated ones."""
    ways = rays(question.against)
    looks = {key: _ray_weights(differences, way) for key, way in ways.items()}
    points, between = np.eye(len(differences.points)), surface_weights(differences.points)
    # One critical value for all that is said of places: points, surface and paths.
    every = np.concatenate([points, between, *looks.values()])
    z = simultaneous(every, differences, question.library_hash)
    flips = tuple(
        _flip(path, sign_of(direction), differences, way, signs, question.up_to)
        for (path, direction), way in ways.items()
        for signs in [Combined.of(looks[path, direction], differences).signs(z).tolist()]
    )
    surface = Combined.of(between, differences)
    side = 2 * UNITS // SHOWN + 1
    means, signs = (values.reshape(side, side) for values in (surface.means, surface.signs(z)))
    record = MapRecord(
        question=question,
        scenes=differences.values.shape[1],
        points=_points(question, differences, Combined.of(points, differences), z),
        surface=MapSurface(
            sizes=tuple(question.size(u) for u in range(-UNITS, UNITS + 1, SHOWN)),
            difference=tuple(tuple(float(v) for v in row) for row in means),
            sign=tuple(tuple(sign_of(v) for v in row) for row in signs),
        ),
        flips=flips,
        joint=joint(question, differences),
        critical=z,
        failed=failed,
        estimand=maps.estimand(question),
        headline="",
        sentences=(),
        findings=tuple(findings),
    )
    texts = {"headline": maps.headline(record), "sentences": maps.sentences(record)}
    return record.model_copy(update=texts)


def _points(
    question: ResolvedMap, differences: Differences, at: Combined, z: float
) -> tuple[MapPoint, ...]:
    low, high = at.ends(z)
    signs, means = at.signs(z), at.means
    return tuple(
        MapPoint(
            errors=(question.size(x), question.size(y)),
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


def _ray_weights(differences: Differences, way: Point) -> Floats:
    known = sizes(way, differences.points)
    looks = np.arange(_BETWEEN * UNITS + 1) / _BETWEEN
    weights = np.zeros((len(looks), len(differences.points)))
    for row, size in zip(np.eye(len(known)), known, strict=True):
        weights[:, differences.points.index(along(way, size))] = np.interp(looks, known, row)
    return weights


def _flip(
    path: str, direction: Sign, differences: Differences, way: Point, signs: list[int], up_to: float
) -> Flip:
    """Return what `signs`, decided at each look at a ray, say of the error along it."""

    def until_other(begin: int) -> int:
        """Return the last look from `begin` on with the same sign."""
        end = begin
        while end + 1 < len(signs) and signs[end + 1] == signs[begin]:
            end += 1
        return end

    start = sign_of(signs[0])
    kept = until_other(0) if start else None
    first = next((i for i, sign in enumerate(signs) if sign and sign != start), None)
    last = None if first is None else until_other(first)
    known = sizes(way, differences.points)
    means = [differences.mean(along(way, size)) for size in known]
    turn, crossing = first_turn(known, means), None
    if turn is not None:
        low, high = (means[known.index(size)] for size in turn)
        crossing = (turn[0] + (turn[1] - turn[0]) * low / (low - high)) * _BETWEEN
    unit = direction * up_to / (UNITS * _BETWEEN)
    until, estimate, begin, end = (
        None if size is None else round(size * unit, 12) for size in (kept, crossing, first, last)
    )
    return Flip(
        path=path,
        direction=direction,
        start=start,
        turned=0 if first is None else sign_of(signs[first]),
        until=until,
        estimate=estimate,
        first=begin,
        last=end,
    )
