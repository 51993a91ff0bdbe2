"""Scenes from a seed: draw a layout, keep it if it is feasible and looks as it was meant to."""

from math import atan2, dist
from typing import Any

from faultpath_quadrotor.scenes.library import clearance_m
from faultpath_quadrotor.scenes.scene import Box, Cylinder, Point, Scene, Topology
from faultpath_quadrotor.vehicle import draw
from feasibility import END_CLEARANCE_M, FreeLattice
from layout import Layout
from topologies import LAYOUTS

from faultpath.core import streams

START_TO_GOAL_M = (6.0, 8.0)
LONGEST_WAY_M = 16.0
"""Twelve seconds at 3.4 m/s are 41 m; the bound keeps detours short of half of that."""

SEEN_AHEAD_OPEN_M = 2.0
SEEN_AHEAD_OCCLUDED_M = 2.5
"""An open scene is found by looking 2.0 m ahead, an occluded one not even by looking 2.5 m. A
one-second plan reaches 1-3 m, depending on the speed at which it begins (v_max 3.4 m/s)."""

_ATTEMPTS = 400


def generate_scene(library: str, index: int, seed: int) -> Scene:
    """Return one scene, the same for the same library name, index and seed.

    Topologies interleave. One in four scenes of each topology is occluded, and half of those
    of walled topologies have loose obstacles, so that any 20 in a row are representative.

    Args:
        library: Name of the library; part of the scene's id.
        index: Place in it.
        seed: Seed of the library.
    """
    topologies = list(Topology)
    turn, row = index % len(topologies), index // len(topologies)
    topology = topologies[turn]
    occluded = (row + turn) % 4 == 0
    # Divided so that occluded scenes have obstacles as often as others.
    obstacles = topology is Topology.CLUTTER or (row // 2 + row // 4 + turn) % 2 == 0
    scene_id = f"{library}/{index:03d}"
    for attempt in range(_ATTEMPTS):
        rng = streams.generator("scene", scene_id, seed, attempt)
        size = tuple(
            float(rng.integers(low, high)) / 10 for low, high in ((86, 95), (56, 65), (28, 33))
        )
        layout = Layout(rng, (size[0], size[1], size[2]))
        LAYOUTS[topology](layout, occluded, obstacles)
        plan = _frozen_plan(layout, mirror=bool(rng.uniform() < 0.5))
        (start_x, start_y, _), (goal_x, goal_y, _) = plan["start_m"], plan["goal_m"]
        scene = Scene(
            id=scene_id,
            index=index,
            library=library,
            topology=topology,
            obstacles=obstacles,
            occluded=occluded,
            bounds=layout.bounds,
            **plan,
            start_yaw_rad=round(atan2(goal_y - start_y, goal_x - start_x), 4),
            vehicle=draw(streams.generator("vehicle", scene_id, seed)),
        )
        if is_sound(scene):
            return scene
    raise RuntimeError(f"no sound layout for {scene_id} in {_ATTEMPTS} attempts")


def is_sound(scene: Scene) -> bool:
    """Return whether a scene is feasible, of the right length, and open or occluded as it says."""
    apart = dist(scene.start_m, scene.goal_m)
    if not START_TO_GOAL_M[0] <= apart <= START_TO_GOAL_M[1]:
        return False
    if min(clearance_m(scene, end) for end in (scene.start_m, scene.goal_m)) < END_CLEARANCE_M:
        return False
    lattice = FreeLattice.of(scene)
    if lattice.path_length_m() > LONGEST_WAY_M:
        return False
    if scene.occluded:
        return not lattice.found_by_looking(SEEN_AHEAD_OCCLUDED_M)
    return lattice.found_by_looking(SEEN_AHEAD_OPEN_M)


def _frozen_plan(layout: Layout, mirror: bool) -> dict[str, Any]:
    turn = -1.0 if mirror else 1.0

    def point(at: Point) -> Point:
        return round(turn * at[0], 3), round(at[1], 3), round(at[2], 3)

    boxes = tuple(
        Box(
            centre_m=point(box.centre_m),
            half_extents_m=point((turn * box.half_extents_m[0], *box.half_extents_m[1:])),
            yaw_rad=round(turn * box.yaw_rad, 4),
        )
        for box in layout.solids
        if isinstance(box, Box)
    )
    cylinders = tuple(
        Cylinder(
            centre_m=(round(turn * pillar.centre_m[0], 3), round(pillar.centre_m[1], 3)),
            radius_m=round(pillar.radius_m, 3),
            low_m=round(pillar.low_m, 3),
            high_m=round(pillar.high_m, 3),
        )
        for pillar in layout.solids
        if isinstance(pillar, Cylinder)
    )
    start, goal = point(layout.start_m), point(layout.goal_m)
    return {"boxes": boxes, "cylinders": cylinders, "start_m": start, "goal_m": goal}
