"""Where the map is sampled: a coarse lattice, cut finer cell by cell, and lines from its centre.

A point is a pair of whole numbers: the error at the first and at the second module, in units of
`1 / UNITS` of the largest error. So points compare exactly, and swap and mirror exactly.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise, product
from typing import TypeAlias

import numpy as np

from faultpath.analyses.model import SHARED
from faultpath.stats.inputs import Floats

Point: TypeAlias = tuple[int, int]

UNITS = 32
"""Units from the centre to the edge."""
COARSE, FINE = 16, 4
"""Spacing of the first lattice, and the least that cells are cut to."""
SHOWN = 2
"""Spacing of the lattice on which the surface is shown."""


def lattice(spacing: int) -> tuple[Point, ...]:
    """Return the points of the whole square, row by row of the second error."""
    places = range(-UNITS, UNITS + 1, spacing)
    return tuple((x, y) for y, x in product(places, places))


def corners(cell: Point, spacing: int) -> tuple[Point, ...]:
    """Return the corners of a cell that is named by its lower left one."""
    x, y = cell
    return tuple((x + i * spacing, y + j * spacing) for j, i in product((0, 1), (0, 1)))


def cut(cell: Point, spacing: int) -> tuple[Point, ...]:
    """Return the points that cut a cell into four: its middle and those of its edges."""
    (x, y), half = cell, spacing // 2
    return tuple(
        (x + i * half, y + j * half)
        for j, i in product((0, 1, 2), (0, 1, 2))
        if (i, j) not in ((0, 0), (0, 2), (2, 0), (2, 2))
    )


def rays(modules: Sequence[str]) -> dict[tuple[str, int], Point]:
    """Return the direction of each condition of the fault, by name and sign."""
    conditions = dict(zip((*modules, SHARED), ((1, 0), (0, 1), (1, 1)), strict=True))
    return {
        (name, sign): (sign * x, sign * y)
        for name, (x, y) in conditions.items()
        for sign in (1, -1)
    }


def along(direction: Point, size: int) -> Point:
    """Return the point of a ray at a size in units."""
    return direction[0] * size, direction[1] * size


def sizes(direction: Point, points: Iterable[Point]) -> tuple[int, ...]:
    """Return the sizes at which points lie on a ray, ascending."""
    known = set(points)
    return tuple(size for size in range(UNITS + 1) if along(direction, size) in known)


def first_turn(known: Sequence[int], means: Sequence[float]) -> tuple[int, int] | None:
    """Return the sizes between which the sign first differs from that at size 0; a tie does not."""
    for (low, _), (high, mean) in pairwise(zip(known, means, strict=True)):
        if means[0] * mean < 0.0:
            return low, high
    return None


@lru_cache(maxsize=4)
def surface_weights(points: tuple[Point, ...]) -> Floats:
    """Return `[lattice(SHOWN), points]`: how the surface follows from the points.

    At a point it is what was measured there. Elsewhere it is halved down from the coarse lattice:
    the middle of an edge is the mean of the edge's ends, the middle of a cell the mean of the
    middles of its edges. So it is continuous, its weights are not negative and add up to 1, and
    without finer points it is bilinear in each cell.
    """
    own = dict(zip(points, np.eye(len(points)), strict=True))
    rows = {place: own[place] for place in lattice(COARSE)}

    def take(place: Point, around: Iterable[Point]) -> None:
        inside = [rows[point] for point in around if max(map(abs, point)) <= UNITS]
        rows[place] = own[place] if place in own else np.mean(inside, axis=0)

    step = COARSE // 2
    while step >= SHOWN:
        new = [place for place in lattice(step) if place not in rows]
        middles = [(x, y) for x, y in new if (x // step) % 2 and (y // step) % 2]
        for x, y in set(new).difference(middles):
            odd = (step, 0) if (x // step) % 2 else (0, step)
            take((x, y), [(x - odd[0], y - odd[1]), (x + odd[0], y + odd[1])])
        for x, y in middles:
            take((x, y), [(x - step, y), (x + step, y), (x, y - step), (x, y + step)])
        step //= 2
    weights = np.stack([rows[place] for place in lattice(SHOWN)])
    weights.setflags(write=False)  # cached
    return weights
