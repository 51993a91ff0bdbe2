"""Scenes in an oblique view: what a vehicle flies through, from start to goal."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from faultpath.report.svg import Point, Svg
from faultpath.trials.declared import FloorPlan, Pillar

_WIDTH, _HEIGHT, _MARGIN, _FOOT = 300.0, 206.0, 6.0, 20.0
_YAW, _PITCH = math.radians(-18), math.radians(33)
_GOAL_RADIUS_M = 0.5
_SIDES = 20

Spot = tuple[float, float, float]
Place = Callable[[Spot], Point]


@dataclass(frozen=True)
class _Face:
    corners: tuple[Spot, ...]
    look: str

    @property
    def away(self) -> float:
        return sum(map(_away, self.corners)) / len(self.corners)


def scene_view(plan: FloorPlan, title: str) -> str:
    """Return a scene as seen from above at an angle, in parallel projection.

    Only faces turned to the viewer are drawn, and those let through what lies behind them. The
    disc is the start; the ring is the goal, with the radius within which it counts as reached.
    """
    told = f"{len(plan.prisms)} blocks and {len(plan.pillars)} pillars between start and goal"
    svg = Svg(_WIDTH, _HEIGHT + _FOOT, f"Scene: {title}", told)
    place = _fit(plan)
    svg.polygon([place(at) for at in _floor(plan)], "ground")
    for a, b in _grid(plan):
        svg.line(place(a), place(b), "axis")
    for face in sorted(_faces(plan), key=lambda face: -face.away):
        svg.polygon([place(corner) for corner in face.corners], f"face {face.look}")
    _ends(svg, plan, place)
    svg.text(_WIDTH / 2, _HEIGHT + _FOOT - 5, title, "", "middle")
    return svg.render()


def _away(at: Spot) -> float:
    x, y, z = at
    deep = math.sin(_YAW) * x + math.cos(_YAW) * y
    return math.cos(_PITCH) * deep - math.sin(_PITCH) * z


def _flat(at: Spot) -> Point:
    x, y, z = at
    deep = math.sin(_YAW) * x + math.cos(_YAW) * y
    across = math.cos(_YAW) * x - math.sin(_YAW) * y
    return across, -(math.sin(_PITCH) * deep + math.cos(_PITCH) * z)


def _fit(plan: FloorPlan) -> Place:
    (x0, y0, z0), (x1, y1, z1) = plan.low, plan.high
    corners = [_flat((x, y, z)) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]
    left, right = min(p[0] for p in corners), max(p[0] for p in corners)
    top, bottom = min(p[1] for p in corners), max(p[1] for p in corners)
    scale = min((_WIDTH - 2 * _MARGIN) / (right - left), (_HEIGHT - 2 * _MARGIN) / (bottom - top))

    def place(at: Spot) -> Point:
        across, down = _flat(at)
        return (
            _WIDTH / 2 + (across - (left + right) / 2) * scale,
            _HEIGHT / 2 + (down - (top + bottom) / 2) * scale,
        )

    return place


def _floor(plan: FloorPlan) -> list[Spot]:
    (x0, y0, z), (x1, y1, _) = plan.low, plan.high
    return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]


def _grid(plan: FloorPlan) -> Iterator[tuple[Spot, Spot]]:
    (x0, y0, z), (x1, y1, _) = plan.low, plan.high
    for x in range(math.ceil(x0), math.ceil(x1)):
        yield (x, y0, z), (x, y1, z)
    for y in range(math.ceil(y0), math.ceil(y1)):
        yield (x0, y, z), (x1, y, z)


def _faces(plan: FloorPlan) -> Iterator[_Face]:
    for prism in plan.prisms:
        yield from _sides(prism.corners, prism.bottom, prism.top, "flat")
    for pillar in plan.pillars:
        yield from _sides(_round(pillar), pillar.bottom, pillar.top, "smooth")


def _round(pillar: Pillar) -> tuple[Point, ...]:
    turns = (2 * math.pi * i / _SIDES for i in range(_SIDES))
    return tuple(
        (pillar.x + pillar.radius * math.cos(t), pillar.y + pillar.radius * math.sin(t))
        for t in turns
    )


def _sides(corners: tuple[Point, ...], bottom: float, top: float, look: str) -> Iterator[_Face]:
    yield _Face(tuple((x, y, top) for x, y in corners), "top")
    turn = math.copysign(1.0, _area(corners))
    for i, (ax, ay) in enumerate(corners):
        bx, by = corners[(i + 1) % len(corners)]
        out_x, out_y = turn * (by - ay), turn * (ax - bx)
        if math.sin(_YAW) * out_x + math.cos(_YAW) * out_y < 0:
            yield _Face(((ax, ay, bottom), (bx, by, bottom), (bx, by, top), (ax, ay, top)), look)


def _area(corners: tuple[Point, ...]) -> float:
    after = (*corners[1:], corners[0])
    return sum(ax * by - bx * ay for (ax, ay), (bx, by) in zip(corners, after, strict=True))


def _ends(svg: Svg, plan: FloorPlan, place: Place) -> None:
    floor = plan.low[2]
    ring = [
        (
            plan.goal[0] + _GOAL_RADIUS_M * math.cos(2 * math.pi * i / 32),
            plan.goal[1] + _GOAL_RADIUS_M * math.sin(2 * math.pi * i / 32),
            plan.goal[2],
        )
        for i in range(32)
    ]
    for end in (plan.start, plan.goal):
        svg.line(place(end), place((end[0], end[1], floor)), "stem")
    svg.polygon([place(at) for at in ring], "goal-ring")
    svg.circle(place(plan.goal), 1.8, "dot")
    svg.circle(place(plan.start), 4, "dot")
    for end, word, lift in ((plan.start, "start", 9.0), (plan.goal, "goal", 15.0)):
        x, y = place(end)
        svg.text(min(max(x, 16.0), _WIDTH - 16.0), y - lift, word, "small halo", "middle")
