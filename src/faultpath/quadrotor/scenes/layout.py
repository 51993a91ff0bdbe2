"""A scene under construction: walls with doors, buildings, loose obstacles, and the gap rule."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np

from faultpath.quadrotor.scenes.scene import Bounds, Box, Cylinder, Point

WALL_M = 0.16  # thicker than the lattice spacing of the distance field
MIN_GAP_M = 0.7  # between loose obstacles and to anything else [BARN, aerial_gym scale]
_FLUSH_M = 1e-6

Plan = tuple[float, float]


@dataclass(frozen=True)
class Door:
    """An opening in a wall.

    Attributes:
        at_m: Centre along the wall.
        width_m: Clear width.
        height_m: Clear height under the lintel; none when the opening goes up to the ceiling.
    """

    at_m: float
    width_m: float
    height_m: float | None = None


@dataclass
class Layout:
    """What a topology builds in its arena; the origin is the middle of the floor.

    Attributes:
        size_m: Length along x, width along y and height of the arena.
        start_m: Start, set by the topology.
        goal_m: Goal, set by the topology.
        boxes: Walls, buildings and boxes so far.
        cylinders: Pillars so far.
        keep_free: Places (x, y, radius) where no loose obstacle may stand.
    """

    size_m: Point
    start_m: Point = (0.0, 0.0, 0.0)
    goal_m: Point = (0.0, 0.0, 0.0)
    boxes: list[Box] = field(default_factory=list[Box])
    cylinders: list[Cylinder] = field(default_factory=list[Cylinder])
    keep_free: list[tuple[float, float, float]] = field(
        default_factory=list[tuple[float, float, float]]
    )

    @property
    def bounds(self) -> Bounds:
        """Inner faces of the arena."""
        x, y, z = self.size_m
        return Bounds(low_m=(-x / 2, -y / 2, 0.0), high_m=(x / 2, y / 2, z))

    def block(self, x: Plan, y: Plan, z: Plan | None = None) -> None:
        """Add a box between coordinates, cut at the arena; it reaches the ceiling by default."""
        spans: list[Plan] = []
        bounds = self.bounds
        for (low, high), floor, ceiling in zip(
            (x, y, z or (0.0, self.size_m[2])), bounds.low_m, bounds.high_m, strict=True
        ):
            # Whole centimetres: middle and half are then exact in the file, and faces still meet.
            spans.append((round(max(low, floor), 2), round(min(high, ceiling), 2)))
        if any(high - low <= _FLUSH_M for low, high in spans):
            return
        cx, cy, cz = ((low + high) / 2 for low, high in spans)
        hx, hy, hz = ((high - low) / 2 for low, high in spans)
        self.boxes.append(Box(centre_m=(cx, cy, cz), half_extents_m=(hx, hy, hz)))

    def wall(
        self, axis: str, at: float, span: Plan | None = None, doors: Sequence[Door] = ()
    ) -> None:
        """Add a wall across the arena, or over a part of it.

        Args:
            axis: The axis it runs along, "x" or "y".
            at: Where its middle plane stands on the other axis, m.
            span: Where it begins and ends along its axis; the whole arena by default.
            doors: Openings, in any order.
        """
        half = self.size_m[0 if axis == "x" else 1] / 2
        begin, end = span or (-half, half)
        thick = (at - WALL_M / 2, at + WALL_M / 2)

        def piece(low: float, high: float, z: Plan | None = None) -> None:
            along = (low, high)
            self.block(*((along, thick) if axis == "x" else (thick, along)), z)

        for door in sorted(doors, key=lambda door: door.at_m):
            low, high = door.at_m - door.width_m / 2, door.at_m + door.width_m / 2
            piece(begin, low)
            if door.height_m is not None:
                piece(low, high, (door.height_m, self.size_m[2]))
            place = (door.at_m, at) if axis == "x" else (at, door.at_m)
            self.keep_free.append((*place, 0.9))
            begin = high
        piece(begin, end)

    def corridor(self, centreline: Sequence[Plan], width: float) -> None:
        """Add the two walls of a corridor along an axis-aligned centreline."""
        steps = [
            (float(np.sign(b[0] - a[0])), float(np.sign(b[1] - a[1])))
            for a, b in pairwise(centreline)
        ]
        reach = (width + WALL_M) / 2
        for side in (-1.0, 1.0):
            # Each vertex moves along the normals of both legs that meet there: a mitred offset.
            corners: list[Plan] = []
            for (x, y), before, after in zip(
                centreline, [steps[0], *steps], [*steps, steps[-1]], strict=True
            ):
                normals = {(-before[1], before[0]), (-after[1], after[0])}
                corners.append(
                    (
                        x + side * reach * sum(n[0] for n in normals),
                        y + side * reach * sum(n[1] for n in normals),
                    )
                )
            for a, b in pairwise(corners):
                low, high = (min(a[0], b[0]), min(a[1], b[1])), (max(a[0], b[0]), max(a[1], b[1]))
                self.block(
                    (low[0] - WALL_M / 2, high[0] + WALL_M / 2),
                    (low[1] - WALL_M / 2, high[1] + WALL_M / 2),
                )

    def pillar(self, at: Plan, radius: float) -> None:
        """Add a pillar from floor to ceiling."""
        self.cylinders.append(
            Cylinder(centre_m=at, radius_m=radius, low_m=0.0, high_m=self.size_m[2])
        )

    def scatter(
        self,
        rng: np.random.Generator,
        count: int,
        x: Plan,
        y: Plan,
        *,
        tall: float = 0.7,
        tries: int = 60,
    ) -> int:
        """Add loose obstacles that keep the gap rule; return how many found a place.

        Args:
            rng: Source of the draws.
            count: How many to add at most.
            x: Where their centres may be, along x.
            y: Where their centres may be, along y.
            tall: Part of them that reaches from floor to ceiling.
            tries: Attempts for each.
        """
        placed = 0
        for _ in range(count):
            for _ in range(tries):
                thing = self._loose(rng, (float(rng.uniform(*x)), float(rng.uniform(*y))), tall)
                if self._fits(thing):
                    if isinstance(thing, Box):
                        self.boxes.append(thing)
                    else:
                        self.cylinders.append(thing)
                    placed += 1
                    break
        return placed

    def _loose(self, rng: np.random.Generator, at: Plan, tall: float) -> Box | Cylinder:
        ceiling = self.size_m[2]
        kind = rng.uniform()
        low, high = 0.0, ceiling
        if kind > tall:
            if rng.uniform() < 0.6:
                high = round(float(rng.uniform(0.7, 1.5)), 2)  # a table or crate to fly over
            else:
                low = round(
                    ceiling - float(rng.uniform(0.6, 1.3)), 2
                )  # a duct or lamp to fly under
        if rng.uniform() < 0.45:
            return Cylinder(
                centre_m=at, radius_m=float(rng.uniform(0.12, 0.35)), low_m=low, high_m=high
            )
        return Box(
            centre_m=(*at, (low + high) / 2),
            half_extents_m=(
                float(rng.uniform(0.12, 0.45)),
                float(rng.uniform(0.12, 0.45)),
                (high - low) / 2,
            ),
            yaw_rad=float(rng.uniform(-pi / 2, pi / 2)),
        )

    def _fits(self, thing: Box | Cylinder) -> bool:
        half_x, half_y = self.size_m[0] / 2, self.size_m[1] / 2
        outline = thing.corners_m if isinstance(thing, Box) else [thing.centre_m]
        grown = 0.0 if isinstance(thing, Box) else thing.radius_m
        if any(min(half_x - abs(x), half_y - abs(y)) < MIN_GAP_M + grown for x, y in outline):
            return False
        if any(plan_gap(thing, other) < MIN_GAP_M for other in (*self.boxes, *self.cylinders)):
            return False
        return all(
            plan_gap(
                thing, Cylinder(centre_m=(x, y), radius_m=radius, low_m=0.0, high_m=self.size_m[2])
            )
            > 0
            for x, y, radius in self.keep_free
        )


def _to_box(point: Plan, box: Box) -> float:
    """Return the distance in plan from a point to a box, 0 inside."""
    dx, dy = point[0] - box.centre_m[0], point[1] - box.centre_m[1]
    c, s = cos(box.yaw_rad), sin(box.yaw_rad)
    beyond_x = abs(c * dx + s * dy) - box.half_extents_m[0]
    beyond_y = abs(c * dy - s * dx) - box.half_extents_m[1]
    return hypot(max(beyond_x, 0.0), max(beyond_y, 0.0))


def plan_gap(one: Box | Cylinder, other: Box | Cylinder) -> float:
    """Return the clear width in plan between two solids that do not cross, m.

    Between convex outlines that are apart, the least distance is taken at a corner of one of
    them. Where outlines cross it is not a distance, but for loose obstacles, whose corners lie
    within 0.64 m of their centre, it stays below the least gap and so still says "too near".
    """
    if isinstance(one, Cylinder) and isinstance(other, Cylinder):
        dx, dy = (a - b for a, b in zip(one.centre_m, other.centre_m, strict=True))
        return hypot(dx, dy) - one.radius_m - other.radius_m
    if isinstance(one, Cylinder):
        return plan_gap(other, one)
    if isinstance(other, Cylinder):
        return _to_box(other.centre_m, one) - other.radius_m
    return min(
        *(_to_box(corner, other) for corner in one.corners_m),
        *(_to_box(corner, one) for corner in other.corners_m),
    )
