"""The solids of a scene as what they all are: upright prisms over rounded rectangles.

A yawed box has no rounding, a pillar is a point rounded by its radius, and the arena is one more
prism with its sign turned round, because there the inside is free. Distances of single points are
taken here; `geometry` takes those of batches, with the same formula. Needs no torch.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, sin

from faultpath.system import FloorPlan, Pillar, Prism
from faultpath_quadrotor.scenes.scene import ArenaBounds, Box, Cylinder, Point, Scene

_BURIED_M = 10.0
"""How far a solid that touches the floor or the ceiling goes on beyond it. What lies beyond is
solid anyway; without it the inside of a pillar would seem shallow near the floor."""

_TOUCH_M = 1e-6

Plan = tuple[float, float]


@dataclass(frozen=True)
class RoundedPrism:
    """An upright prism over a rounded rectangle, in the world frame."""

    centre_m: Point  # centre of the plan and mid height
    half_m: Point  # half extents of the rectangle along its own axes and half the height
    yaw_rad: float = 0.0  # angle from world x to the rectangle's first axis
    rounding_m: float = 0.0  # radius by which the rectangle is grown
    sign: float = 1.0  # +1 when the prism is solid, -1 when it is the free inside of the arena

    @property
    def corners_m(self) -> tuple[Plan, ...]:
        """The four corners of the rectangle in plan, in order around it."""
        (x, y, _), (hx, hy, _) = self.centre_m, self.half_m
        c, s = cos(self.yaw_rad), sin(self.yaw_rad)
        return tuple(
            (x + c * along - s * across, y + s * along + c * across)
            for along, across in ((-hx, -hy), (hx, -hy), (hx, hy), (-hx, hy))
        )

    def plan_distance(self, point: Plan) -> float:
        """Return the signed distance in plan from a point to the outline, m."""
        (x, y, _), (hx, hy, _) = self.centre_m, self.half_m
        dx, dy = point[0] - x, point[1] - y
        c, s = cos(self.yaw_rad), sin(self.yaw_rad)
        return _corner(abs(c * dx + s * dy) - hx, abs(c * dy - s * dx) - hy) - self.rounding_m

    def distance(self, point: Point) -> float:
        """Return the signed distance from a point to the surface, m."""
        *plan, height = point
        beyond = abs(height - self.centre_m[2]) - self.half_m[2]
        return self.sign * _corner(self.plan_distance((plan[0], plan[1])), beyond)


def arena(scene: Scene) -> RoundedPrism:
    """Return the free inside of a scene's boundaries."""
    pairs = list(zip(scene.bounds.low_m, scene.bounds.high_m, strict=True))
    x, y, z = ((low + high) / 2 for low, high in pairs)
    hx, hy, hz = ((high - low) / 2 for low, high in pairs)
    return RoundedPrism((x, y, z), (hx, hy, hz), sign=-1.0)


def solids(scene: Scene) -> list[RoundedPrism]:
    """Return the obstacles of a scene, boxes first, continued beyond floor and ceiling."""
    return [prism(solid, scene.bounds) for solid in (*scene.boxes, *scene.cylinders)]


def prism(solid: Box | Cylinder, bounds: ArenaBounds | None = None) -> RoundedPrism:
    """Return a solid as a prism; between `bounds` it goes on beyond a face that it touches."""
    if isinstance(solid, Box):
        (x, y, z), (hx, hy, hz) = solid.centre_m, solid.half_extents_m
        low, high, yaw, rounding = z - hz, z + hz, solid.yaw_rad, 0.0
    else:
        (x, y), (hx, hy) = solid.centre_m, (0.0, 0.0)
        low, high, yaw, rounding = solid.low_m, solid.high_m, 0.0, solid.radius_m
    if bounds is not None:
        if low <= bounds.low_m[2] + _TOUCH_M:
            low -= _BURIED_M
        if high >= bounds.high_m[2] - _TOUCH_M:
            high += _BURIED_M
    return RoundedPrism((x, y, (low + high) / 2), (hx, hy, (high - low) / 2), yaw, rounding)


def _corner(first: float, second: float) -> float:
    return hypot(max(first, 0.0), max(second, 0.0)) + min(max(first, second), 0.0)


def floor_plan(scene: Scene, free_space: bool = False) -> FloorPlan:
    """Return the floor plan of a scene, or of its arena alone.

    Lowest shapes come first, so that what hangs is drawn on top.
    """
    prisms = [
        Prism(
            corners=prism(box).corners_m,
            bottom=round(box.centre_m[2] - box.half_extents_m[2], 6),
            top=round(box.centre_m[2] + box.half_extents_m[2], 6),
        )
        for box in scene.boxes
    ]
    pillars = [
        Pillar(*pillar.centre_m, pillar.radius_m, pillar.low_m, pillar.high_m)
        for pillar in scene.cylinders
    ]
    return FloorPlan(
        low=scene.bounds.low_m,
        high=scene.bounds.high_m,
        prisms=() if free_space else tuple(sorted(prisms, key=lambda shape: shape.bottom)),
        pillars=() if free_space else tuple(sorted(pillars, key=lambda shape: shape.bottom)),
        start=scene.start_m,
        goal=scene.goal_m,
        title=f"{scene.id} {scene.topology}",
    )
