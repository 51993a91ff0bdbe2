"""A scene's floor plan as plain shapes, to draw in two and three dimensions; needs no torch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faultpath.quadrotor.scenes.scene import Point, Scene


@dataclass(frozen=True)
class Polygon:
    """An upright prism over a polygon, m.

    Attributes:
        corners_m: Corners in plan (x, y), in order around it.
        low_m: Height of its underside.
        high_m: Height of its top.
    """

    corners_m: tuple[tuple[float, float], ...]
    low_m: float
    high_m: float


@dataclass(frozen=True)
class Circle:
    """An upright pillar, m."""

    centre_m: tuple[float, float]
    radius_m: float
    low_m: float
    high_m: float


@dataclass(frozen=True)
class FloorPlan:
    """What a drawing of one scene needs; lengths in metres, world frame.

    Attributes:
        title: The scene's id and topology.
        low_m: Low corner of the arena.
        high_m: High corner of the arena.
        polygons: Boxes and walls, lowest first, so that what hangs is drawn on top.
        circles: Pillars, lowest first.
        start_m: Start.
        goal_m: Goal.
    """

    title: str
    low_m: Point
    high_m: Point
    polygons: tuple[Polygon, ...]
    circles: tuple[Circle, ...]
    start_m: Point
    goal_m: Point


def floor_plan(scene: Scene, free_space: bool = False) -> FloorPlan:
    """Return the floor plan of a scene.

    Args:
        scene: The scene.
        free_space: Keep only the arena, as the free-space variant does.
    """
    polygons = [
        Polygon(
            corners_m=box.corners_m,
            low_m=round(box.centre_m[2] - box.half_extents_m[2], 6),
            high_m=round(box.centre_m[2] + box.half_extents_m[2], 6),
        )
        for box in scene.boxes
    ]
    circles = [
        Circle(pillar.centre_m, pillar.radius_m, pillar.low_m, pillar.high_m)
        for pillar in scene.cylinders
    ]
    return FloorPlan(
        title=f"{scene.id} {scene.topology}",
        low_m=scene.bounds.low_m,
        high_m=scene.bounds.high_m,
        polygons=() if free_space else tuple(sorted(polygons, key=lambda shape: shape.low_m)),
        circles=() if free_space else tuple(sorted(circles, key=lambda shape: shape.low_m)),
        start_m=scene.start_m,
        goal_m=scene.goal_m,
    )
