"""A scene's floor plan as plain shapes, to draw in two and three dimensions; needs no torch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from faultpath.trials.declared import FloorPlan, Pillar, Prism
from faultpath_quadrotor.scenes.prisms import prism

if TYPE_CHECKING:
    from faultpath_quadrotor.scenes.scene import Scene


def floor_plan(scene: Scene, free_space: bool = False) -> FloorPlan:
    """Return the floor plan of a scene, lowest shapes first, so that what hangs is drawn on top.

    Args:
        scene: The scene.
        free_space: Keep only the arena, as the free-space variant does.
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
