"""One layout per topology, each in an open and in an occluded form.

In the open form, going towards what is in sight leads to the goal. In the occluded form it leads
into a dead end (a pocket, a wall whose door is far to the side, a closed street), so that a planner
that looks about one second ahead has to give up distance to the goal which it cannot win back yet.
Numbers: doorways 0.9-1.2 m, corridors 1.5-2.2 m, clutter gaps from 0.7 m.
"""

from collections.abc import Callable

import numpy as np
from faultpath_quadrotor.scenes.scene import Topology
from layout import WALL_M, Door, Layout

_Range = tuple[float, float]


def _door(room: Layout, at: float) -> Door:
    height = room.within(2.0, 2.3) if room.chance(0.6) else None
    return Door(at, room.within(0.9, 1.2), height)


def clutter(room: Layout, occluded: bool, obstacles: bool) -> None:
    """Loose boxes and pillars in an open hall; occluded: a pocket open towards the start.

    It is nothing but obstacles, so `obstacles` only thins it out.
    """
    half_x, half_y = room.half_m
    reach = half_y - 1.4
    start_y, goal_y = room.within(-reach, reach), room.within(-reach, reach)
    if occluded:
        start_y, goal_y = room.within(-0.7, 0.7), room.within(-0.7, 0.7)
    room.ends(start_y, goal_y)
    if occluded:
        back, depth = room.within(0.2, 1.2), room.within(1.2, 1.7)
        middle, mouth = (start_y + goal_y) / 2, room.within(1.35, 1.6)
        room.wall("y", back, (middle - mouth, middle + mouth))
        for side in (-mouth, mouth):
            room.wall("x", middle + side, (back - depth, back + WALL_M / 2))
    else:
        # One obstacle in the way, so that no scene is a flight through empty air.
        share = room.within(0.35, 0.65)
        x = (1 - share) * room.start_m[0] + share * room.goal_m[0]
        y = (1 - share) * start_y + share * goal_y
        room.scatter(1, (x - 0.15, x + 0.15), (y - 0.15, y + 0.15), tall=1.0)
    count = int(room.rng.integers(11, 16)) if obstacles else int(room.rng.integers(5, 8))
    room.scatter(count, (-half_x + 1.7, half_x - 1.7), (-half_y, half_y))


def rooms(room: Layout, occluded: bool, obstacles: bool) -> None:
    """Four rooms round a crossing of walls; occluded: the way leads through the far two."""
    half_x, half_y = room.half_m
    cross_x, cross_y = room.within(-0.6, 0.6), room.within(-0.25, 0.25)
    near = room.sign()  # the side of the partition on which the start lies
    middle = near * half_y / 2 + cross_y / 2
    start_y = middle + room.within(-0.4, 0.4)
    goal_y = middle + room.within(-0.4, 0.4)
    far = -near * half_y / 2 + cross_y / 2
    room.ends(start_y, goal_y)
    beside = _door(room, far + room.within(-0.5, 0.5))
    through = _door(room, (start_y + goal_y) / 2 + room.within(-0.5, 0.5))
    room.wall("y", cross_x, doors=[beside] if occluded else [beside, through])
    room.wall(
        "x",
        cross_y,
        doors=[
            _door(room, cross_x - room.within(1.0, 2.4)),
            _door(room, cross_x + room.within(1.0, 2.4)),
        ],
    )
    if obstacles:
        room.scatter(5, (-half_x, half_x), (-half_y, half_y), tall=0.5)


def corridors(room: Layout, occluded: bool, obstacles: bool) -> None:
    """A corridor with a jog; occluded: it goes round a building that stands before the goal."""
    half_x, half_y = room.half_m
    width = room.within(1.5, 2.2)
    side = room.sign()
    if occluded:
        width = min(width, 1.9)
        low = -(half_y - width / 2 - WALL_M)
        high = room.within(low + width + 1.0, -low)
        out, back = room.within(-1.9, -1.4), room.within(1.5, 2.0)
        line = [(-half_x, low), (out, low), (out, high), (back, high), (back, low), (half_x, low)]
    else:
        reach = half_y - width / 2 - WALL_M
        jog = room.within(0.0, 1.0)
        low = room.within(-reach, reach - jog)
        turn = room.within(-1.5, 1.5)
        line = [(-half_x, low), (turn, low), (turn, low + jog), (half_x, low + jog)]
    line = [(x, side * y) for x, y in line]
    room.ends(line[0][1], line[-1][1])
    room.corridor(line, width)
    if obstacles:
        _piers(room, line[0], line[1], width)
        _piers(room, line[-2], line[-1], width)


def _piers(
    room: Layout,
    a: tuple[float, float],
    b: tuple[float, float],
    width: float,
) -> None:
    """Narrow a straight leg along x by a pier at one wall; at least 0.9 m stay open."""
    low, high = min(a[0], b[0]) + 2.0, max(a[0], b[0]) - 0.9
    if high <= low:
        low, high = min(a[0], b[0]) + 0.9, max(a[0], b[0]) - 2.0
    if high <= low:
        return
    x, side = room.within(low, high), room.sign()
    depth = min(room.within(0.3, 0.7), width - 0.9)
    top = room.within(1.0, 1.6) if room.chance(0.3) else room.size_m[2]
    wall = a[1] + side * width / 2
    span = sorted((wall, wall - side * depth))
    length = room.within(0.2, 0.5)
    room.block((x - length / 2, x + length / 2), (span[0], span[1]), (0.0, top))


def doorways(room: Layout, occluded: bool, obstacles: bool) -> None:
    """Two walls across the hall, a door in each; occluded: a door lies far off the line."""
    half_x, half_y = room.half_m
    edge = half_y - 0.9
    first, second = room.within(-2.0, -1.2), room.within(1.2, 2.0)
    if occluded:
        side = room.sign()
        start_y, goal_y = (room.within(-0.9, 0.3) * side for _ in range(2))
        far = room.within(edge - 0.3, edge) * side
        doors = [far, room.within(-edge, 0.0) * side]
        if room.chance(0.5):
            doors = [room.within(-0.6, 0.6), far]
            goal_y = -room.within(0.6, 1.6) * side
    else:
        start_y, goal_y = (room.within(-1.2, 1.2) for _ in range(2))
        doors = [
            float(
                np.clip(start_y + share * (goal_y - start_y) + room.within(-0.8, 0.8), -edge, edge)
            )
            for share in (1 / 3, 2 / 3)
        ]
    room.ends(start_y, goal_y)
    for x, door in zip((first, second), doors, strict=True):
        room.wall("y", x, doors=[_door(room, door)])
    if obstacles:
        room.scatter(4, (-half_x + 1.0, half_x - 1.0), (-half_y, half_y), tall=0.6)


def intersections(room: Layout, occluded: bool, obstacles: bool) -> None:
    """Streets between buildings, straight on or round a corner; occluded: straight on is closed."""
    half_x, half_y = room.half_m
    side = room.sign()
    street, lane = room.within(1.5, 2.0), room.within(1.5, 2.2)

    def building(x: _Range, y: _Range) -> None:
        low, high = sorted((side * y[0], side * y[1]))
        room.block(x, (low, high))

    if occluded:
        # Two parallel streets joined by two cross streets; the near one is closed in between.
        near, far = -half_y + street, half_y - street
        west, east = room.within(-2.0, -1.4), room.within(1.4, 2.0)
        room.ends(side * (-half_y + street / 2), side * (-half_y + street / 2))
        building((-half_x, west - lane / 2), (near, far))
        building((west + lane / 2, east - lane / 2), (near, far))
        building((east + lane / 2, half_x), (near, far))
        gate = room.within(west + lane / 2 + 0.2, east - lane / 2)
        building((gate, gate + WALL_M), (-half_y, near))
        return _posts(room, obstacles, (west, east), side * far, side * half_y)
    middle = room.within(-0.8, 0.8)
    turning = room.chance(0.5)
    cross = half_x - 1.0 - lane / 2 if turning else room.within(-1.0, 1.0)
    south, north = middle - street / 2, middle + street / 2
    room.ends(side * middle, side * (middle + room.within(-0.3, 0.3)))
    if turning:  # round the corner into the cross street
        room.goal_m = (cross, side * (half_y - 0.8), room.goal_m[2])
        room.keep_free.clear()
        room.reserve_ends()
    for x in ((-half_x, cross - lane / 2), (cross + lane / 2, half_x)):
        building(x, (-half_y, south))
        building(x, (north, half_y))
    return _posts(room, obstacles, (-1.5, cross), side * south, side * north)


def _posts(
    room: Layout,
    obstacles: bool,
    places: _Range,
    one_side: float,
    other_side: float,
) -> None:
    """Stand posts in a street along x, off its middle so that one side stays wide open."""
    if not obstacles:
        return
    low, high = sorted((one_side, other_side))
    for x in places:
        radius = room.within(0.10, 0.16)
        reach = (high - low) / 2 - radius
        y = (low + high) / 2 + room.sign() * room.within(0.55, 1.0) * reach
        room.pillar((x, y), radius)


LAYOUTS: dict[Topology, Callable[[Layout, bool, bool], None]] = {
    Topology.CLUTTER: clutter,
    Topology.ROOMS: rooms,
    Topology.CORRIDORS: corridors,
    Topology.DOORWAYS: doorways,
    Topology.INTERSECTIONS: intersections,
}
