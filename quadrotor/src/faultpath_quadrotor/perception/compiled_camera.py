"""The depth camera, compiled."""

import ctypes

import torch
from torch import Tensor

from faultpath_quadrotor.native.lending import Block, fields, lend
from faultpath_quadrotor.native.library import WIDEST, Kernels

_SOLID = 12
"""Numbers of a `Solid` in `render_view.hpp`."""
_WIDEST_IMAGE = 64
"""Columns for which `render.cpp` has room."""


class _Camera(Block):
    """`Camera` of `render_view.hpp`."""

    _fields_ = (
        *fields(ctypes.c_int64, "height width"),
        *fields(ctypes.c_void_p, "left up planes"),
        ("range", ctypes.c_float),
    )


class CompiledRenderer:
    """Draws the depth images of a block of scenes."""

    def __init__(
        self,
        kernels: Kernels,
        solids: Tensor,
        slopes: tuple[Tensor, Tensor],
        planes: Tensor,
        range_m: float,
    ) -> None:
        """Prepare the solids of B scenes.

        Args:
            kernels: What draws.
            solids: K prisms a scene, the arena first, `[12, K, B]`: cosine and sine of the yaw, the
                centre along the prism's axes, half extents, rounding, sign, and from which to which
                height above its centre it can be seen; m, float64.
            slopes: How far the pixels' rays go left `[64]` and up `[36]` per metre forward.
            planes: Inward normals of the view and their offsets, `[6, 4]`.
            range_m: What a pixel reads that sees nothing.

        Raises:
            ValueError: The image is wider than the kernel's rows or not whole vectors wide, or
                there is no prism.
        """
        self._kernels = kernels
        _, count, scenes = solids.shape
        laid = solids.permute(2, 1, 0).contiguous()
        self._solids = lend("solids", laid, scenes, count, _SOLID, dtype=torch.float64)
        left, up = (slope.float().contiguous() for slope in slopes)
        self._shape = (len(up), len(left))
        if not count or not len(up) or not 0 < len(left) <= _WIDEST_IMAGE or len(left) % WIDEST:
            raise ValueError(
                f"the camera's kernel draws images of {WIDEST} to {_WIDEST_IMAGE} columns, in "
                f"multiples of {WIDEST}, and an arena; it was given {len(left)} columns and "
                f"{count} prisms"
            )
        self._camera = _Camera(
            *self._shape,
            lend("left", left, len(left)),
            lend("up", up, len(up)),
            lend("planes", planes.double().contiguous(), 6, 4, dtype=torch.float64),
            range_m,
        )

    def render(self, position: Tensor, rotation: Tensor) -> Tensor:
        """Return `[B, 36, 64]` as cameras at `[3, B]` of attitudes `[3, 3, B]` see it, float64."""
        scenes, count, _ = self._solids.tensor.shape
        images = torch.empty(scenes, *self._shape)
        at = position.expand(3, scenes).contiguous()
        turned = rotation.expand(3, 3, scenes).contiguous()
        self._kernels.call(
            "faultpath_render",
            *(self._camera, self._solids, count, scenes),
            lend("position", at, 3, scenes, dtype=torch.float64),
            lend("rotation", turned, 3, 3, scenes, dtype=torch.float64),
            scenes,
            lend("images", images, scenes, *self._shape),
        )
        return images
