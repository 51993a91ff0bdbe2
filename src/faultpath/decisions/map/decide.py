"""From the trials of a map to its record."""

from collections.abc import Sequence

import numpy as np

from faultpath.decisions.map import words
from faultpath.decisions.map.asked import MapQuestion
from faultpath.decisions.map.grow import first_turn
from faultpath.decisions.map.joint import Errors, Expected
from faultpath.decisions.map.lattice import (
    SHOWN,
    UNITS,
    Point,
    along,
    rays,
    sizes,
    surface_weights,
)
from faultpath.decisions.map.model import (
    CorrelationRegion,
    Expectation,
    Flip,
    JointErrors,
    MapPoint,
    MapRecord,
    MapSurface,
)
from faultpath.decisions.map.study import MapPlan
from faultpath.decisions.map.surface import Combined, Differences, simultaneous
from faultpath.statistics import Sign
from faultpath.statistics.inputs import Floats
from faultpath.trials import OutcomeTable
from faultpath.trials.pairing import mismatch_words

_BETWEEN = 4
"""Looks at a ray for each unit."""
CURVE = np.linspace(-1.0, 1.0, 41)


def conclude(
    plan: MapPlan, points: Sequence[Point], table: OutcomeTable, findings: Sequence[str] = ()
) -> MapRecord:
    """Return the record of a map, to the bit the same in whatever order its points were flown.

    `UserError` where a point has no pair left.
    """
    points = sorted(points)
    compared = plan.compared(points, table)
    found = plan.differences(points, compared)
    found_too = (*mismatch_words(compared.mismatches), *findings)
    return decided(plan.question, found, len(table.failed()), found_too)


def decided(
    question: MapQuestion, found: Differences, failed: int = 0, findings: Sequence[str] = ()
) -> MapRecord:
    """Return the record of differences, which may be simulated ones."""
    label, up_to = question.library_hash, question.up_to
    flips, z = turns(found, question.against, up_to, label)
    record = MapRecord(
        question=question,
        scenes=found.values.shape[1],
        points=_points(question, found, z),
        surface=_surface(Combined.of(surface_weights(found.points), found), up_to, z),
        flips=flips,
        joint=_joint(question, found),
        critical=z,
        failed=failed,
        estimand=words.estimand(question),
        headline="",
        sentences=(),
        findings=tuple(findings),
    )
    said = {"headline": words.headline(record), "sentences": words.sentences(record)}
    return record.model_copy(update=said)


def turns(
    found: Differences, against: Sequence[str], up_to: float, label: str
) -> tuple[tuple[Flip, ...], float]:
    """Return which errors turn the verdict on each path, and the critical value of the map.

    There is one value for all that is said of places: points, surface and paths.
    """
    ways = rays(against)
    paths = {key: _ray_weights(found, way) for key, way in ways.items()}
    flown = np.eye(len(found.points))
    every = np.concatenate([flown, surface_weights(found.points), *paths.values()])
    z = simultaneous(every, found, label)
    flips = (
        _flip(key, found, ways[key], Combined.of(weights, found), up_to, z)
        for key, weights in paths.items()
    )
    return tuple(flips), z


def _points(question: MapQuestion, found: Differences, z: float) -> tuple[MapPoint, ...]:
    all_ = Combined.of(np.eye(len(found.points)), found)
    low, high = all_.ends(z)
    signs, means = all_.signs(z), all_.means
    return tuple(
        MapPoint(
            errors=(_size(point[0], question.up_to), _size(point[1], question.up_to)),
            baseline_percent=100.0 * float(found.baseline[i].mean()),
            repair_percent=100.0 * float(found.repair[i].mean()),
            difference=float(means[i]),
            low=float(low[i]),
            high=float(high[i]),
            sign=_sign(signs[i]),
            won=int((found.values[i] > 0).sum()),
            lost=int((found.values[i] < 0).sum()),
        )
        for i, point in sorted(enumerate(found.points), key=lambda each: each[1])
    )


def _surface(all_: Combined, up_to: float, z: float) -> MapSurface:
    side = 2 * UNITS // SHOWN + 1
    means, signs = (each.reshape(side, side) for each in (all_.means, all_.signs(z)))
    return MapSurface(
        sizes=tuple(_size(u, up_to) for u in range(-UNITS, UNITS + 1, SHOWN)),
        difference=tuple(tuple(float(v) for v in row) for row in means),
        sign=tuple(tuple(_sign(v) for v in row) for row in signs),
    )


def _ray_weights(found: Differences, way: Point) -> Floats:
    known = sizes(way, found.points)
    looks = np.arange(_BETWEEN * UNITS + 1) / _BETWEEN
    own = np.eye(len(known))
    shares = np.stack([np.interp(looks, known, row) for row in own], axis=1)
    weights = np.zeros((len(looks), len(found.points)))
    for column, size in enumerate(known):
        weights[:, found.points.index(along(way, size))] = shares[:, column]
    return weights


def _flip(
    key: tuple[str, int], found: Differences, way: Point, all_: Combined, up_to: float, z: float
) -> Flip:
    path, direction = key
    signs = all_.signs(z)
    start = _sign(signs[0])
    unit = direction * up_to / (UNITS * _BETWEEN)
    kept = int(np.argmax(np.append(signs, 2) != start)) - 1 if start else None
    other = np.flatnonzero((signs != start) & (signs != 0))
    first = int(other[0]) if len(other) else None
    last, turned = None, 0
    if first is not None:
        turned = signs[first]
        last = first + int(np.argmax(np.append(signs[first:], 2) != turned)) - 1
    known = sizes(way, found.points)
    means = [found.mean(along(way, size)) for size in known]
    turn = first_turn(known, means)
    crossing = None
    if turn is not None:
        low, high = (means[known.index(each)] for each in turn)
        crossing = (turn[0] + (turn[1] - turn[0]) * low / (low - high)) * _BETWEEN
    until, estimate, begin, end = (
        None if each is None else round(each * unit, 12) for each in (kept, crossing, first, last)
    )
    return Flip(
        path=path,
        direction=_sign(direction),
        start=start,
        turned=_sign(turned),
        until=until,
        estimate=estimate,
        first=begin,
        last=end,
    )


def _joint(question: MapQuestion, found: Differences) -> JointErrors:
    (m1, m2), (s1, s2), largest = question.means, question.spreads, question.up_to
    errors = Errors((m1 / largest, m2 / largest), (s1 / largest, s2 / largest))
    expected = Expected.over(errors, found, question.library_hash)
    pieces = expected.pieces()
    edges = [-1.0, *(edge for piece in pieces for edge in piece), 1.0]
    spans = [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]
    middles = [0.5 * (a + b) for a, b in spans]
    means: list[float] = expected.at(middles).means.tolist() if middles else []
    wanted = {0.0, 1.0} if question.correlation is None else {0.0, 1.0, question.correlation}
    return JointErrors(
        curve=_expectations(expected, CURVE.tolist()),
        asked=_expectations(expected, sorted(wanted)),
        estimates=expected.crossings(),
        undecided=pieces,
        regions=tuple(
            CorrelationRegion(low=low, high=high, sign=_sign(mean))
            for (low, high), mean in zip(spans, means, strict=True)
        ),
        outside=max(errors.outside(each) for each in CURVE.tolist()),
        critical=expected.z,
    )


def _expectations(expected: Expected, correlations: Sequence[float]) -> tuple[Expectation, ...]:
    all_ = expected.at(correlations)
    columns = (all_.means, *all_.ends(expected.z), all_.signs(expected.z, tested=False))
    return tuple(
        Expectation(
            correlation=at, value=float(value), low=float(low), high=float(high), sign=_sign(sign)
        )
        for at, value, low, high, sign in zip(correlations, *columns, strict=True)
    )


def _size(units: float, up_to: float) -> float:
    return round(up_to * units / UNITS, 12) + 0.0


def _sign(value: float) -> Sign:
    return 1 if value > 0 else -1 if value < 0 else 0
