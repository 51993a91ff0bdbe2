"""Which points to fly next, from what the points so far have shown: same data, same points."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from faultpath.decisions.map.lattice import (
    COARSE,
    FINE,
    Point,
    along,
    corners,
    cut,
    lattice,
    rays,
    sizes,
)
from faultpath.decisions.map.surface import Combined, Differences, simultaneous


def next_points(
    found: Differences, modules: Sequence[str], limit: int, label: str
) -> tuple[Point, ...]:
    """Return the points to add, none when the map is done.

    First cells are cut in which the sign is not decided, the largest cells first, until there are
    `limit` points or cells of the least size. Then, on each path of the fault, the first change of
    the estimate's sign is bisected down to one unit.
    """
    return _refined(found, limit, label) or _bisected(found, modules)


def _refined(found: Differences, limit: int, label: str) -> tuple[Point, ...]:
    every = np.eye(len(found.points))
    decided = Combined.of(every, found).signs(simultaneous(every, found, label))
    signs = dict(zip(found.points, decided.tolist(), strict=True))
    means = dict(zip(found.points, found.values.mean(axis=1).tolist(), strict=True))
    spacing = COARSE
    while spacing > FINE:
        new: dict[Point, None] = {}
        cells = [cell for cell in lattice(spacing) if _undecided(corners(cell, spacing), signs)]
        for cell in sorted(cells, key=lambda cell: _urgency(corners(cell, spacing), means)):
            added = [point for point in cut(cell, spacing) if point not in signs]
            if len(signs) + len({*new, *added}) <= limit:
                new.update(dict.fromkeys(added))
        if new:
            return tuple(sorted(new))
        spacing //= 2
    return ()


def _undecided(around: Sequence[Point], signs: Mapping[Point, int]) -> bool:
    return all(each in signs for each in around) and {signs[each] for each in around} not in (
        {1},
        {-1},
    )


def _urgency(around: Sequence[Point], means: Mapping[Point, float]) -> tuple[bool, float, Point]:
    values = [means[each] for each in around]
    return min(values) * max(values) >= 0.0, abs(sum(values)), around[0]


def _bisected(found: Differences, modules: Sequence[str]) -> tuple[Point, ...]:
    new: dict[Point, None] = {}
    for direction in rays(modules).values():
        known = sizes(direction, found.points)
        turn = first_turn(known, [found.mean(along(direction, size)) for size in known])
        if turn is not None and turn[1] - turn[0] > 1:
            new[along(direction, sum(turn) // 2)] = None
    return tuple(new)


def first_turn(known: Sequence[int], means: Sequence[float]) -> tuple[int, int] | None:
    """Return the sizes between which the sign first differs from that at size 0; a tie does not."""
    start = means[0]
    for (low, _), (high, mean) in pairwise(zip(known, means, strict=True)):
        if start * mean < 0.0:
            return low, high
    return None
