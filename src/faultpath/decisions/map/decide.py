"""From the trials of a map to its record."""

from collections.abc import Sequence

import numpy as np

from faultpath.decisions.map import words
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
from faultpath.decisions.map.model import Flip, MapPoint, MapQuestion, MapRecord, MapSurface
from faultpath.decisions.map.study import MapPlan
from faultpath.decisions.map.surface import Combined, Differences, sign_of, simultaneous
from faultpath.statistics import Sign
from faultpath.statistics.inputs import Floats
from faultpath.trials import OutcomeTable
from faultpath.trials.pairing import mismatch_words

_BETWEEN = 4
"""Looks at a ray for each unit."""


def conclude(
    plan: MapPlan, points: Sequence[Point], table: OutcomeTable, findings: Sequence[str] = ()
) -> MapRecord:
    """Return the record of a map, to the bit the same in whatever order its points were run.

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
    flips, z = turns(found, question.against, question.up_to, question.library_hash)
    record = MapRecord(
        question=question,
        scenes=found.values.shape[1],
        points=_points(question, found, z),
        surface=_surface(Combined.of(surface_weights(found.points), found), question.up_to, z),
        flips=flips,
        joint=joint(question, found),
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
    """Return which errors reverse the ranking on each path, and the critical value of the map.

    There is one value for all that is said of places: points, surface and paths.
    """
    ways = rays(against)
    looks = {key: _ray_weights(found, way) for key, way in ways.items()}
    points = np.eye(len(found.points))
    every = np.concatenate([points, surface_weights(found.points), *looks.values()])
    z = simultaneous(every, found, label)
    flips: list[Flip] = []
    for (path, direction), way in ways.items():
        signs = Combined.of(looks[path, direction], found).signs(z).tolist()
        flips.append(_flip(path, sign_of(direction), found, way, signs, up_to))
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
            sign=sign_of(signs[i]),
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
        sign=tuple(tuple(sign_of(v) for v in row) for row in signs),
    )


def _size(units: float, up_to: float) -> float:
    return round(up_to * units / UNITS, 12) + 0.0


def _ray_weights(found: Differences, way: Point) -> Floats:
    known = sizes(way, found.points)
    looks = np.arange(_BETWEEN * UNITS + 1) / _BETWEEN
    weights = np.zeros((len(looks), len(found.points)))
    for row, size in zip(np.eye(len(known)), known, strict=True):
        weights[:, found.points.index(along(way, size))] = np.interp(looks, known, row)
    return weights


def _flip(
    path: str, direction: Sign, found: Differences, way: Point, signs: list[int], up_to: float
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
    known = sizes(way, found.points)
    means = [found.mean(along(way, size)) for size in known]
    turn, crossing = first_turn(known, means), None
    if turn is not None:
        low, high = (means[known.index(each)] for each in turn)
        crossing = (turn[0] + (turn[1] - turn[0]) * low / (low - high)) * _BETWEEN
    unit = direction * up_to / (UNITS * _BETWEEN)
    until, estimate, begin, end = (
        None if each is None else round(each * unit, 12) for each in (kept, crossing, first, last)
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
