"""Exact signed distance to a scene's obstacles and boundaries, batched over scenes.

One formula serves all prisms (`prisms`), and a short scene is padded by repeating its arena, which
cannot change a minimum.

The distance is exact in free space. Inside solids it is minus the depth below the surface of the
deepest prism, so where two prisms overlap it understates the depth of their union; its sign is
exact everywhere. Only correctly rounded operations are used (no fused multiply-add, no `hypot`), so
that a value does not depend on where in the batch it stands.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import torch
from torch import Tensor

from faultpath_quadrotor.scenes.prisms import arena, solids
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.so3 import root


def rectangle_distance(beyond_x: Tensor, beyond_y: Tensor) -> Tensor:
    """Return the signed distance in the plane from how far a point lies beyond each edge pair."""
    out_x, out_y = beyond_x.clamp_min(0), beyond_y.clamp_min(0)
    outside = root(out_x.mul_(out_x) + out_y.mul_(out_y))
    return outside.add_(torch.maximum(beyond_x, beyond_y).clamp_max_(0))


@dataclass(frozen=True)
class Geometry:
    """Prisms of a batch of scenes, padded to the same number: K prisms, B scenes."""

    along_x: Tensor  # what world x adds to each local coordinate, `[3, K, B]`
    along_y: Tensor  # what world y adds, `[3, K, B]`
    along_z: Tensor  # what world z adds, `[3, 1, 1]`
    offset: Tensor  # local coordinates of the centres, `[3, K, B]`, m
    half: Tensor  # half extents, `[3, K, B]`, m
    rounding: Tensor  # rounding radii, `[K, B]`, m
    sign: Tensor  # +1 solid, -1 arena, `[K, B]`

    @classmethod
    def stack(
        cls,
        scenes: Sequence[Scene],
        free_space: bool = False,
        device: torch.device | str | None = None,
    ) -> "Geometry":
        """Gather the geometry of scenes, or of their boundaries alone."""
        lists = [[arena(scene), *([] if free_space else solids(scene))] for scene in scenes]
        count = max(map(len, lists))
        padded = [prisms + prisms[:1] * (count - len(prisms)) for prisms in lists]

        def table(rows: list[list[list[float]]]) -> Tensor:  # [B, K, F] -> [F, K, B]
            whole = torch.tensor(rows, dtype=torch.float64, device=device)
            return whole.permute(2, 1, 0).contiguous()

        turn = table([[[cos(p.yaw_rad), sin(p.yaw_rad)] for p in row] for row in padded])
        zero = torch.zeros_like(turn[0])
        along_x = torch.stack([turn[0], -turn[1], zero])
        along_y = torch.stack([turn[1], turn[0], zero])
        along_z = torch.tensor([0.0, 0.0, 1.0]).to(turn).view(3, 1, 1)
        centre = table([[list(p.centre_m) for p in row] for row in padded])
        edge = table([[[p.rounding_m, p.sign] for p in row] for row in padded])
        return cls(
            along_x=along_x,
            along_y=along_y,
            along_z=along_z,
            offset=along_x * centre[0] + along_y * centre[1] + along_z * centre[2],
            half=table([[list(p.half_m) for p in row] for row in padded]),
            rounding=edge[0],
            sign=edge[1],
        )

    def numbers(self) -> Tensor:
        """Return each prism as kernels read it, `[10, K, B]`.

        Cosine and sine of the yaw, offset, half extents, rounding and sign.
        """
        turn = (self.along_x[:1], self.along_y[:1])
        return torch.cat((*turn, self.offset, self.half, self.rounding[None], self.sign[None]))

    def distance(self, points: Tensor) -> Tensor:
        """Return the signed distance `[B, ...]` of points `[3, B, ...]` to the nearest surface, m.

        World frame; positive in free space, negative in solids and outside the arena.
        """
        tail = (1,) * (points.dim() - 2)
        parts = (self.along_x, self.along_y, self.along_z, self.offset, self.half)
        along_x, along_y, along_z, offset, half, rounding, sign = (
            part.view(part.shape + tail) for part in (*parts, self.rounding, self.sign)
        )
        x, y, z = points.unbind(0)
        local = (along_x * x).add_(along_y * y).add_(along_z * z).sub_(offset)
        beyond_x, beyond_y, beyond_z = local.abs_().sub_(half).unbind(0)
        plan = rectangle_distance(beyond_x, beyond_y).sub_(rounding)
        return rectangle_distance(plan, beyond_z).mul_(sign).amin(0)
