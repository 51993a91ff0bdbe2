"""The depth camera, compiled."""

import ctypes

import torch
from torch import Tensor

from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.scenes.geometry import Geometry


class _Camera(ctypes.Structure):
    """`Camera` of `render_view.hpp`."""

    _fields_ = (
        ("height", ctypes.c_int64),
        ("width", ctypes.c_int64),
        ("left", ctypes.c_void_p),
        ("up", ctypes.c_void_p),
        ("planes", ctypes.c_void_p),
        ("range", ctypes.c_float),
    )


class CompiledRenderer:
    """Draws the depth images of a block of scenes."""

    def __init__(
        self,
        kernels: Kernels,
        geometry: Geometry,
        heights: tuple[Tensor, Tensor],
        slopes: tuple[Tensor, Tensor],
        planes: Tensor,
        range_m: float,
    ) -> None:
        """Prepare the solids of B scenes.

        Args:
            kernels: What draws.
            geometry: K prisms a scene, the arena first.
            heights: From which to which height above its centre a prism can be seen, `[K, B]`, m.
            slopes: How far the pixels' rays go left `[64]` and up `[36]` per metre forward.
            planes: Inward normals of the view and their offsets, `[6, 4]`.
            range_m: What a pixel reads that sees nothing.
        """
        self._kernels = kernels
        rows = (
            geometry.along_x[:1],  # the cosine of each prism's yaw
            geometry.along_y[:1],  # and its sine
            geometry.offset,
            geometry.half,
            geometry.rounding[None],
            geometry.sign[None],
            *(height[None] for height in heights),
        )
        self._solids = torch.cat(rows).permute(2, 1, 0).contiguous()  # `Solid` of the same header
        left, up = (slope.float().contiguous() for slope in slopes)
        self._kept = (left, up, planes.double().contiguous())  # the kernel holds addresses only
        self._shape = (len(up), len(left))
        self._camera = _Camera(*self._shape, *(part.data_ptr() for part in self._kept), range_m)

    def render(self, position: Tensor, rotation: Tensor) -> Tensor:
        """Return `[B, 36, 64]` as cameras at `[3, B]` of attitudes `[3, 3, B]` see it, float64."""
        scenes, count, _ = self._solids.shape
        images = torch.empty(scenes, *self._shape)
        self._kernels.call(
            "faultpath_render",
            ctypes.byref(self._camera),
            self._solids,
            *(count, scenes),
            position.expand(3, scenes).contiguous(),
            rotation.expand(3, 3, scenes).contiguous(),
            scenes,
            images,
        )
        return images
