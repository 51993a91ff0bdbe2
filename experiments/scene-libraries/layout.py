"""A scene under construction: walls with doors, buildings, loose obstacles, and the gap rule."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import pi

import numpy as np
from faultpath_quadrotor.scenes.prisms import Plan, Prism, prism
from faultpath_quadrotor.scenes.scene import ArenaBounds, Box, Cylinder, Point

WALL_M = 0.16  # thicker than the lattice spacing of the distance field
MIN_GAP_M = 0.7  # between loose obstacles and to anything else [BARN, aerial_gym scale]
_FLUSH_M = 1e-6
_TRIES = 60  # places that a loose obstacle is tried at


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
    """Obstacles that a topology builds in its arena; the origin is the middle of the floor.

    Attributes:
        rng: Source of all draws.
        size_m: Length along x, width along y and height of the arena.
        start_m: Start, set by the topology.
        goal_m: Goal, set by the topology.
        solids: Walls, buildings, boxes and pillars so far.
        keep_free: Pillars of air in which no loose obstacle may stand.
    """

    rng: np.random.Generator
    size_m: Point
    start_m: Point = (0.0, 0.0, 0.0)
    goal_m: Point = (0.0, 0.0, 0.0)
    solids: list[Box | Cylinder] = field(default_factory=list[Box | Cylinder])
    keep_free: list[Prism] = field(default_factory=list[Prism])

    @property
    def half_m(self) -> Plan:
        """Half of length and width."""
        return self.size_m[0] / 2, self.size_m[1] / 2

    def within(self, low: float, high: float) -> float:
        """Draw a number between two bounds."""
        return float(self.rng.uniform(low, high))

    def chance(self, probability: float) -> bool:
        """Draw whether something is so."""
        return bool(self.rng.uniform() < probability)

    def sign(self) -> float:
        """Draw -1 or 1."""
        return float(self.rng.choice((-1.0, 1.0)))

    def ends(self, start_y: float, goal_y: float) -> None:
        """Put start and goal near the two short sides, at flying height."""
        half, _ = self.half_m
        start_x, goal_x = -half + self.within(0.8, 1.1), half - self.within(0.8, 1.1)
        self.start_m = (start_x, start_y, self.within(1.0, 1.7))
        self.goal_m = (goal_x, goal_y, self.within(1.0, 1.7))
        self.reserve_ends()

    def reserve_ends(self) -> None:
        """Keep the air about start and goal free."""
        for x, y, _ in (self.start_m, self.goal_m):
            self._reserve((x, y), 0.6)

    def _reserve(self, at: Plan, radius: float) -> None:
        self.keep_free.append(prism(self._pillar(at, radius)))

    def _pillar(self, at: Plan, radius: float) -> Cylinder:
        return Cylinder(centre_m=at, radius_m=radius, low_m=0.0, high_m=self.size_m[2])

    @property
    def bounds(self) -> ArenaBounds:
        """Inner faces of the arena."""
        x, y, z = self.size_m
        return ArenaBounds(low_m=(-x / 2, -y / 2, 0.0), high_m=(x / 2, y / 2, z))

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
        self.solids.append(Box(centre_m=(cx, cy, cz), half_extents_m=(hx, hy, hz)))

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
        half = self.half_m["xy".index(axis)]
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
            self._reserve(place, 0.9)
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
        self.solids.append(self._pillar(at, radius))

    def scatter(self, count: int, x: Plan, y: Plan, *, tall: float = 0.7) -> None:
        """Add loose obstacles that keep the gap rule; what finds no place is left out.

        Args:
            count: How many to add at most.
            x: Where their centres may be, along x.
            y: Where their centres may be, along y.
            tall: Part of them that reaches from floor to ceiling.
        """
        for _ in range(count):
            for _ in range(_TRIES):
                thing = self._loose((self.within(*x), self.within(*y)), tall)
                if self._fits(prism(thing)):
                    self.solids.append(thing)
                    break

    def _loose(self, at: Plan, tall: float) -> Box | Cylinder:
        low, high = 0.0, self.size_m[2]
        if not self.chance(tall):  # it stands on the floor or hangs from the ceiling
            if self.chance(0.6):
                high = round(self.within(0.7, 1.5), 2)  # a table or crate to fly over
            else:
                low = round(high - self.within(0.6, 1.3), 2)  # a duct or lamp to fly under
        if self.chance(0.45):
            radius = self.within(0.12, 0.35)
            return Cylinder(centre_m=at, radius_m=radius, low_m=low, high_m=high)
        plan = self.within(0.12, 0.45), self.within(0.12, 0.45)
        return Box(
            centre_m=(*at, (low + high) / 2),
            half_extents_m=(*plan, (high - low) / 2),
            yaw_rad=self.within(-pi / 2, pi / 2),
        )

    def _fits(self, thing: Prism) -> bool:
        half_x, half_y = self.half_m
        wall = MIN_GAP_M + thing.rounding_m
        if any(min(half_x - abs(x), half_y - abs(y)) < wall for x, y in thing.corners_m):
            return False
        if any(plan_gap(thing, prism(other)) < MIN_GAP_M for other in self.solids):
            return False
        return all(plan_gap(thing, place) > 0 for place in self.keep_free)


def plan_gap(one: Prism, other: Prism) -> float:
    """Return the clear width in plan between two solids that do not cross, m.

    Between convex outlines that are apart, the least distance is taken at a corner of one of
    them. Where outlines cross it is not a distance, but for loose obstacles, whose corners lie
    within 0.64 m of their centre, it stays below the least gap and so still says "too near".
    """
    return min(
        a.plan_distance(corner) - b.rounding_m
        for a, b in ((one, other), (other, one))
        for corner in b.corners_m
    )
