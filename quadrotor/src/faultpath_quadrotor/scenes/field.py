"""The distance to a scene baked on a lattice, for planners that ask about many points.

`DistanceField` holds one flat table for any number of scenes. All lattices are laid out with the
same pitch, so that the eight corners of a point's cell are read with one index from eight shifted
views of the table, each read being consumed while it is in the cache. (Corners packed side by side
take eight times the memory, and were measured to be slower.)

Between lattice points the value is trilinear; `docs/design/scenes.md` gives its error. Outside the
arena it goes on falling without end (cells at the border extrapolate): minus the sum of the
distances beyond each wall, which trilinear cells reproduce, to rounding, however far a point lies.
"""

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from math import ceil, cos, sin

import torch
from torch import Tensor

from faultpath_quadrotor import native
from faultpath_quadrotor.native.kernel_args import Block, covered, fields, lend, output
from faultpath_quadrotor.scenes.geometry import rectangle_distance
from faultpath_quadrotor.scenes.library import CELL_M
from faultpath_quadrotor.scenes.prisms import RoundedPrism, arena, solids
from faultpath_quadrotor.scenes.scene import Scene

_MARGIN = 2
_ROUNDING = 1e-6
"""Part of a cell, and of a metre, that is rounding: 9 m are 90 cells of 0.1 m, not 91."""


@dataclass(frozen=True)
class Lattice:
    """The lattice of one scene: the arena and two cells beyond each face.

    The outer of the two has no corner on a face, where a wall's depth may count, so that what lies
    further out follows the arena alone.
    """

    axes: tuple[Tensor, Tensor, Tensor]
    """World coordinates of the lattice points along x, y and z, m, float64."""

    @classmethod
    def over(cls, scene: Scene) -> "Lattice":
        """Return the lattice that covers a scene; its third point is the arena's low corner."""
        axes: list[Tensor] = []
        for low, high in zip(scene.bounds.low_m, scene.bounds.high_m, strict=True):
            cells = ceil((high - low) / CELL_M - _ROUNDING)
            steps = torch.arange(-_MARGIN, cells + 1 + _MARGIN, dtype=torch.float64)
            axes.append(low + steps * CELL_M)
        return cls((axes[0], axes[1], axes[2]))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of lattice points along x, y and z."""
        x, y, z = self.axes
        return len(x), len(y), len(z)


def exact_on_lattice(scene: Scene, lattice: Lattice, free_space: bool = False) -> Tensor:
    """Return the signed distance at every lattice point, `[nx, ny, nz]`, m, float64.

    Inside the arena it equals `Geometry.distance`; outside it is the sum described above. Prisms of
    one height range are first combined in plan, where the lattice is small: growing upwards
    is monotone in the plan distance, so the minimum may be taken before it.
    """
    x, y, z = lattice.axes
    walls = arena(scene)
    beyond = [
        (axis - centre).abs() - half
        for axis, centre, half in zip(lattice.axes, walls.centre_m, walls.half_m, strict=True)
    ]
    beyond_x, beyond_y, beyond_z = beyond[0][:, None, None], beyond[1][:, None], beyond[2]
    outside = beyond_x.clamp_min(0) + beyond_y.clamp_min(0) + beyond_z.clamp_min(0)
    inside = -torch.maximum(torch.maximum(beyond_x, beyond_y), beyond_z)
    value = torch.where(outside > _ROUNDING, -outside, inside)
    if free_space:
        return value

    def height(prism: RoundedPrism) -> tuple[float, float]:
        return prism.centre_m[2], prism.half_m[2]

    free = value
    for (mid, half), prisms in groupby(sorted(solids(scene), key=height), key=height):
        plan = _plan_distance(list(prisms), x, y)[:, :, None]
        free = torch.minimum(free, rectangle_distance(plan, (z - mid).abs() - half))
    return torch.where(outside > _ROUNDING, value, free)


def _plan_distance(prisms: list[RoundedPrism], x: Tensor, y: Tensor) -> Tensor:
    table = torch.tensor(
        [
            [*p.centre_m[:2], *p.half_m[:2], cos(p.yaw_rad), sin(p.yaw_rad), p.rounding_m]
            for p in prisms
        ],
        dtype=torch.float64,
    ).T[:, :, None, None]
    centre_x, centre_y, half_x, half_y, cosine, sine, rounding = table
    dx, dy = x[:, None] - centre_x, y - centre_y
    turned_x = cosine * dx + sine * dy
    turned_y = cosine * dy - sine * dx
    plan = rectangle_distance(turned_x.abs() - half_x, turned_y.abs() - half_y) - rounding
    return plan.amin(0)


class _Field(Block):
    """`Field` of `field.cpp`."""

    _fields_ = (
        ("table", ctypes.c_void_p),
        *fields(ctypes.c_int64, "along_x along_y"),
        *fields(ctypes.c_void_p, "origin last first"),
        ("per_metre", ctypes.c_float),
    )


@dataclass(frozen=True)
class DistanceField:
    """Baked distance of B scenes."""

    table: Tensor  # values at the lattice points of all scenes baked together, `[P]`, m, z fastest
    pitch: tuple[int, int, int]  # table places per step along x, along y and along z
    origin: Tensor  # first lattice point, `[3, B, 1]`, m
    last: Tensor  # greatest cell number along each axis, `[3, B, 1]`
    first: Tensor  # table place of each scene's first lattice point, `[B, 1]`, int32
    per_metre: float  # cells per metre

    @classmethod
    def bake(
        cls,
        scenes: Sequence[Scene],
        free_space: bool = False,
        device: torch.device | str | None = None,
    ) -> "DistanceField":
        """Bake scenes, or their boundaries alone, into one table: about 0.8 MB each."""
        lattices = list(map(Lattice.over, scenes))
        shapes = torch.tensor([lattice.shape for lattice in lattices])  # [B, 3]
        nx, ny, nz = (int(n) for n in shapes.amax(0))
        table = torch.zeros(len(scenes), nx, ny, nz)
        for room, scene, lattice in zip(table, scenes, lattices, strict=True):
            x, y, z = lattice.shape
            room[:x, :y, :z] = exact_on_lattice(scene, lattice, free_space)
        origin = torch.tensor([[axis[0] for axis in lattice.axes] for lattice in lattices])
        return cls(
            table=table.flatten().to(device),
            pitch=(ny * nz, nz, 1),
            origin=origin.float().T[:, :, None].contiguous().to(device),
            last=(shapes - 2).float().T[:, :, None].contiguous().to(device),
            first=(torch.arange(len(scenes)) * nx * ny * nz).int()[:, None].to(device),
            per_metre=1.0 / CELL_M,
        )

    def select(self, rows: Tensor) -> "DistanceField":
        """Return the field of some scenes, in the order of their rows; the table is shared."""
        return replace(
            self, origin=self.origin[:, rows], last=self.last[:, rows], first=self.first[rows]
        )

    def query(self, points: Tensor) -> Tensor:
        """Return the signed distance `[B, N]` at points `[3, B, N]`, world frame, m.

        It is not truncated. A point with a coordinate that is not a number gets NaN.
        """
        kernels = native.kernels_on(self.table.device)
        field = None if kernels is None else self._field
        if kernels is None or field is None:
            return self._interpolate(points)
        scenes, count = len(self.first), points.shape[2]
        distances, points = output(scenes, count), points.expand(3, scenes, count).float()
        queried = lend("points", points, 3, scenes, count)
        kernels.call("faultpath_field", field, queried, scenes, count, distances)
        return distances.tensor

    @cached_property
    def _field(self) -> _Field | None:
        """The field as its kernel reads it; `ValueError` where a cell lies outside the table."""
        if not covered(self, DistanceField):
            return None
        scenes = len(self.first)
        steps = torch.tensor(self.pitch, dtype=torch.float64)[:, None, None]
        furthest = (self.last * steps).sum(0) + self.first + sum(self.pitch)
        inside = (self.first >= 0) & (self.last >= 0).all(0) & (furthest < len(self.table))
        if self.pitch[2] != 1 or min(self.pitch) < 1 or not bool(inside.all()):
            raise ValueError(f"distance field: cells of pitch {self.pitch} lie outside its table")
        return _Field(
            lend("table", self.table, self.table.numel()),
            *self.pitch[:2],
            lend("origin", self.origin, 3, scenes, 1),
            lend("last", self.last, 3, scenes, 1),
            lend("first", self.first, scenes, 1, dtype=torch.int32),
            self.per_metre,
        )

    def _interpolate(self, points: Tensor) -> Tensor:
        local = (points - self.origin).mul_(self.per_metre)
        cell = torch.minimum(local, self.last).clamp_min_(0).floor_()
        x, y, z = local.sub_(cell).flatten(1)  # within the cell, or beyond it at the border
        # Places within one scene stay below 2^24, up to where float32 counts exactly.
        place = cell[0].mul_(self.pitch[0]).add_(cell[1].mul_(self.pitch[1])).add_(cell[2])
        # NaN converts to any integer: keep the read inside the table, the fraction stays NaN.
        most = len(self.table) - 1 - sum(self.pitch)
        index = place.to(torch.int32).add_(self.first).clamp_(0, most).flatten()
        along_x, along_y, along_z = self.pitch

        def edge(shift: int) -> Tensor:  # between two lattice points along x
            near = self.table[shift:].index_select(0, index)
            return _between(near, self.table[shift + along_x :].index_select(0, index), x)

        near = _between(edge(0), edge(along_y), y)
        far = _between(edge(along_z), edge(along_z + along_y), y)
        return _between(near, far, z).view(points.shape[1:])


def _between(low: Tensor, high: Tensor, fraction: Tensor) -> Tensor:
    """Return low + fraction (high - low), reusing `high`.

    Not the fused kernel: it rounds the last elements of a tensor apart from the rest.
    """
    return high.sub_(low).mul_(fraction).add_(low)
