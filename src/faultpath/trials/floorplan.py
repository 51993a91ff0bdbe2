"""The shapes of a scene that a report can draw, free of any simulator."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Prism:
    """A vertical prism: corners `(x, y)` in order, from `bottom` to `top`, metres."""

    corners: tuple[tuple[float, float], ...]
    bottom: float
    top: float


@dataclass(frozen=True)
class Pillar:
    """A vertical cylinder, metres."""

    x: float
    y: float
    radius: float
    bottom: float
    top: float


@dataclass(frozen=True)
class FloorPlan:
    """A scene seen from above: `low` and `high` are the corners of the free volume, metres."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    prisms: tuple[Prism, ...]
    pillars: tuple[Pillar, ...]
    start: tuple[float, float, float]
    goal: tuple[float, float, float]
    title: str
