"""What a vehicle hit: the part of its scene that is nearest to where a crash ended its flight."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from faultpath.trials import FloorPlan

_NEAR_M = 0.75
"""Farther away than a vehicle is wide, nothing was hit: a crash may be something else."""


class Hit(NamedTuple):
    """A part of a scene."""

    words: str
    solid: int | None
    """Its place among the prisms and, after them, the pillars; `None` for a side of the volume."""


def hit(plan: FloorPlan, at: NDArray[Any]) -> Hit | None:
    """Return what is nearest to the point `at` `[3]`, metres; `None` where nothing is near."""
    near = [each for each in _distances(plan, at) if each[0] <= _NEAR_M]
    return min(near, key=lambda each: each[0])[1] if near else None


def _distances(plan: FloorPlan, at: NDArray[Any]) -> Iterator[tuple[float, Hit]]:
    x, y, z = map(float, at)
    for number, prism in enumerate(plan.prisms):
        aside = _from_polygon(x, y, prism.corners)
        yield np.hypot(aside, _outside(z, prism.bottom, prism.top)), Hit("an obstacle", number)
    for number, pillar in enumerate(plan.pillars, len(plan.prisms)):
        aside = max(np.hypot(x - pillar.x, y - pillar.y) - pillar.radius, 0.0)
        yield np.hypot(aside, _outside(z, pillar.bottom, pillar.top)), Hit("a pillar", number)
    if plan.low[2] < plan.high[2]:  # on a plane, or along a line, nothing is above or beside
        yield max(z - plan.low[2], 0.0), Hit("the floor", None)
        yield max(plan.high[2] - z, 0.0), Hit("the ceiling", None)
    for axis, value in enumerate((x, y)):
        if plan.low[axis] == plan.high[axis]:
            continue
        for side in (value - plan.low[axis], plan.high[axis] - value):
            yield max(side, 0.0), Hit("the edge of the free volume", None)


def _outside(value: float, low: float, high: float) -> float:
    return max(low - value, value - high, 0.0)


def _from_polygon(x: float, y: float, corners: Sequence[tuple[float, float]]) -> float:
    inside, nearest = False, np.inf
    for (ax, ay), (bx, by) in zip(corners, (*corners[1:], corners[0]), strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
        dx, dy = bx - ax, by - ay
        along = np.clip(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy or 1.0), 0.0, 1.0)
        nearest = min(nearest, float(np.hypot(x - ax - along * dx, y - ay - along * dy)))
    return 0.0 if inside else nearest
