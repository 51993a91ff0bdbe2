"""Depth images by closed-form ray casting against the prisms that contact uses.

Along a ray every solid occupies one interval: a yawed box by the slab test in its own axes, a
pillar by the chord of its circle, both cut by their slab of heights. The image is the least entry
over all solids and the exit from the arena.

The compiled kernel (`compiled.py`) does the same scene by scene, and works on the part of
the image that a solid can cover. This is its reference, and draws where there is none.

Every pixel is an elementwise function of its own scene, and an image's rows are whole vectors, so
that a scene's image has the same bits in a batch of any size.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from faultpath_quadrotor import native
from faultpath_quadrotor.device import CPU, host_readable
from faultpath_quadrotor.native.kernel_args import covered
from faultpath_quadrotor.perception.camera import FOCAL_PX, HEIGHT, RANGE_M, WIDTH, slopes
from faultpath_quadrotor.perception.compiled import CompiledRenderer
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.state import Batched, State

_GROUP = 16
"""Scenes drawn at once, which bounds the scratch images."""

_NOT_ZERO = 1e-20
"""Added to directions: an exact zero gets an inverse, every other number stays what it is."""

_PLANES = torch.tensor(
    [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [WIDTH / 2 / FOCAL_PX, -1.0, 0.0],
        [WIDTH / 2 / FOCAL_PX, 1.0, 0.0],
        [HEIGHT / 2 / FOCAL_PX, 0.0, -1.0],
        [HEIGHT / 2 / FOCAL_PX, 0.0, 1.0],
    ],
    dtype=torch.float64,
)
"""Inward normals of the view: front, range, right, left, top, bottom; camera frame."""

_OFFSETS = torch.tensor([0.0, RANGE_M, 0.0, 0.0, 0.0, 0.0], dtype=torch.float64)


@dataclass(frozen=True)
class _View(Batched):
    """The solids as the cameras see them; K prisms, L scenes, float64."""

    eye: Tensor  # the camera in the axes of each prism, from its centre, `[3, K, L]`, m
    axes: Tensor  # the camera's axes in the axes of each prism, `[3 prism, 3 camera, K, L]`
    half: Tensor  # half extents, `[3, K, L]`, m
    rounding: Tensor  # rounding radii, `[K, L]`, m
    seen: Tensor  # whether any of a solid may be in the image, `[K, L]`


class DepthRenderer:
    """Draws what the cameras of a block of scenes see."""

    def __init__(
        self, scenes: Sequence[Scene], free_space: bool = False, device: torch.device = CPU
    ) -> None:
        """Prepare the solids of B scenes, or their boundaries alone."""
        geometry = Geometry.stack(scenes, free_space, device=device)
        self._geometry = geometry
        self._low, self._high = _within_arena(geometry)
        left, up = (slope.to(device) for slope in slopes())
        self._left, self._up = left.float(), up.float()[:, None]
        self._planes, self._offsets = _PLANES.to(device), _OFFSETS.to(device)
        prisms, drawn = geometry.sign.shape
        most = prisms * (min(_GROUP, drawn) if host_readable(device) else drawn)
        self._scratch = torch.empty(3, 3, most, HEIGHT, WIDTH, device=device)
        kernels = native.kernels_on(device)
        self._compiled: CompiledRenderer | None = None
        if kernels is not None and covered(self, DepthRenderer):
            self._compiled = CompiledRenderer(
                kernels,
                torch.cat((geometry.numbers(), self._low[None], self._high[None])),
                torch.cat((_PLANES, _OFFSETS[:, None]), 1),
            )

    def render(self, state: State) -> Tensor:
        """Return what the cameras of vehicles see, z-depth `[B, 36, 64]`, m, float32, in [0, 6].

        That is the range where nothing is nearer, and zero where the camera is inside a solid. Of
        the state, lane b in scene b, only position and rotation count.
        """
        count = self._geometry.sign.shape[1]
        position, rotation = state.position[:, :count], state.rotation[..., :count]
        position, rotation = position.double(), rotation.double()
        if self._compiled is not None:
            return self._compiled.render(position, rotation)
        view = self._view(position, rotation)
        if not host_readable(position.device):
            return self._draw(view)
        groups = (slice(first, first + _GROUP) for first in range(0, count, _GROUP))
        return torch.cat([self._draw(view.take(group)) for group in groups])

    def _view(self, position: Tensor, rotation: Tensor) -> _View:
        g = self._geometry
        along = torch.stack((g.along_x, g.along_y, g.along_z.expand_as(g.along_x)))
        eye = (along * position[:, None, None]).sum(0).sub_(g.offset)
        axes = (along[:, :, None] * rotation[:, None, :, None]).sum(0)
        middle, half = eye.neg(), g.half + g.rounding
        middle[2] += (self._high + self._low) / 2
        half[2] = (self._high - self._low) / 2
        # Out of view: even the corner furthest along some inward normal is behind its plane.
        normals = (self._planes[..., None, None, None] * axes.movedim(1, 0)).sum(1)
        furthest = (normals * middle + normals.abs() * half).sum(1) + self._offsets[:, None, None]
        seen = (furthest >= 0).all(0) & (g.sign > 0)
        return _View(eye, axes, g.half, g.rounding, seen)

    def _draw(self, view: _View) -> Tensor:
        """Return the images of some scenes: every solid is drawn, then masked where out of view.

        Only the device knows how many are in view.
        """
        arena = view.map(lambda part: part[..., 0, :].float()[..., None, None])
        image = self._box(arena)[1].clamp_(0, RANGE_M)
        solids = view.map(lambda part: part.float().flatten(-2)[..., None, None])
        pillar = view.rounding > 0
        for visible, interval in (
            (view.seen & ~pillar, self._box),
            (view.seen & pillar, self._pillar),
        ):
            enter, leave = interval(solids)
            hidden = (enter.clamp_(min=0) > leave) | ~visible.flatten()[:, None, None]
            nearest = enter.masked_fill_(hidden, RANGE_M).unflatten(0, visible.shape).amin(0)
            torch.minimum(image, nearest, out=image)
        return image

    def _box(self, solid: _View) -> tuple[Tensor, Tensor]:
        return self._slabs(solid.eye, solid.axes, solid.half)

    def _pillar(self, solid: _View) -> tuple[Tensor, Tensor]:
        """Cut the chord of the circle out of the slab of heights.

        With the eye e and the direction d in plan the chord is (-e.d +- sqrt(r^2 d.d - (e x d)^2))
        / d.d; the cross product keeps the digits that the usual discriminant cancels.
        """
        eye, axes = solid.eye, solid.axes
        enter, leave = self._slabs(eye[2:], axes[2:], solid.half[2:])
        direction = self._directions(axes[:2])
        x, y = direction.unbind(0)
        along = (x * eye[0]).add_(y * eye[1]).neg_()
        across = (y * eye[0]).sub_(x * eye[1])
        square = direction.square_().sum(0).add_(_NOT_ZERO)
        root = (square * solid.rounding.square()).sub_(across.square_())
        missed = root < 0
        root.clamp_(min=0).sqrt_()
        chord_in, chord_out = (along - root).div_(square), along.add_(root).div_(square)
        chord_out.masked_fill_(missed, -1.0)
        return torch.maximum(enter, chord_in), torch.minimum(leave, chord_out)

    def _slabs(self, eye: Tensor, axes: Tensor, half: Tensor) -> tuple[Tensor, Tensor]:
        """Return the depths at which rays enter and leave all slabs |coordinate| <= half.

        `eye` and `half` are `[A, n, 1, 1]`, the camera's `axes` `[A, 3, n, 1, 1]`.
        """
        inverse = self._directions(axes).add_(_NOT_ZERO).reciprocal_()
        count, size = eye.shape[:2]
        radius = torch.abs(inverse, out=self._scratch[1, :count, :size]).mul_(half)
        middle = inverse.mul_(-eye)
        enter = torch.sub(middle, radius, out=self._scratch[2, :count, :size])
        return enter.amax(0), middle.add_(radius).amin(0)

    def _directions(self, axes: Tensor) -> Tensor:
        forward, left, up = axes.unbind(1)
        out = self._scratch[0, : axes.shape[0], : axes.shape[2]]
        return torch.add(forward + left * self._left, up * self._up, out=out)


def _within_arena(geometry: Geometry) -> tuple[Tensor, Tensor]:
    """Return the least and greatest height above its centre at which each solid can be seen.

    Both are `[K, B]`, m. Solids go on beyond floor and ceiling; no camera in the arena sees that.
    """
    middle, half = geometry.offset[2], geometry.half[2]
    floor, ceiling = middle[0] - half[0], middle[0] + half[0]
    return torch.maximum(-half, floor - middle), torch.minimum(half, ceiling - middle)
