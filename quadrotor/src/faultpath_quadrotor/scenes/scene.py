"""The frozen record of one scene: geometry, start and goal, and the vehicle that flies there."""

import hashlib
import json
from enum import StrEnum

from pydantic import Field

from faultpath.plugin.system import Frozen
from faultpath_quadrotor.vehicle import VehicleParameters

Point = tuple[float, float, float]


class Topology(StrEnum):
    """Kinds of layout, in the order in which they interleave in a library [paper, setup]."""

    CLUTTER = "clutter"
    ROOMS = "rooms"
    CORRIDORS = "corridors"
    DOORWAYS = "doorways"
    INTERSECTIONS = "intersections"


class ArenaBounds(Frozen, allow_inf_nan=False):
    """Inner faces of floor, ceiling and walls: the free box between two corners, m."""

    low_m: Point
    high_m: Point


class Box(Frozen, allow_inf_nan=False):
    """A solid box turned about the vertical; full sides are twice the half extents."""

    centre_m: Point
    half_extents_m: Point
    yaw_rad: float = 0.0


class Cylinder(Frozen, allow_inf_nan=False):
    """A solid upright pillar between two heights."""

    centre_m: tuple[float, float]
    radius_m: float = Field(gt=0)
    low_m: float
    high_m: float


class Scene(Frozen, allow_inf_nan=False):
    """One scene of a library; it never changes, and its content hash says so.

    Attributes:
        id: Library and place in it, such as `held-out/017`; keys random streams.
        index: Place in the library; topologies interleave (index modulo five).
        library: Name of the library.
        topology: Kind of layout.
        obstacles: Whether loose obstacles stand in the layout.
        occluded: Whether the layout was designed so that the way on is hidden behind a wall or
            a pocket that a one-second horizon does not see past.
        bounds: Inner faces of the arena.
        boxes: Walls, lintels and box-shaped obstacles.
        cylinders: Pillars.
        start_m: Where the vehicle's centre starts, at rest.
        goal_m: Where it must come within 0.5 m [paper, setup].
        start_yaw_rad: Heading at the start.
        vehicle: The frozen draw of this scene's vehicle.
    """

    id: str
    index: int = Field(ge=0)
    library: str
    topology: Topology
    obstacles: bool
    occluded: bool
    bounds: ArenaBounds
    boxes: tuple[Box, ...]
    cylinders: tuple[Cylinder, ...]
    start_m: Point
    goal_m: Point
    start_yaw_rad: float
    vehicle: VehicleParameters

    @property
    def content_hash(self) -> str:
        """Hexadecimal digest of everything above, 32 characters."""
        return digest(self.model_dump(mode="json"))


def digest(content: object) -> str:
    """Return the hash of JSON-like content in canonical form (sorted keys, no spaces)."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()
