"""The depth camera: a pin-hole at the body's centre, level, that looks where the body heads.

Its frame: x forward (the optical axis), y left, z up. A stabilised mount keeps it level, because a
vehicle that accelerates pitches by more than half the image is high. Depth is z-depth, as
depth cameras deliver it: the distance along the optical axis, not along the ray. A pixel therefore
sees the point `depth * ray`, where the first component of every ray is one. The capture frame is
the camera's pose when the image was taken.
"""

from math import radians, tan

import torch
from torch import Tensor

from faultpath_quadrotor import so3

WIDTH = 64
HEIGHT = 36
FIELD_OF_VIEW_DEG = 87.0
"""Horizontal, from edge to edge of the image [Intel RealSense D455; the vertical one follows from
the square pixels, 56 degrees]."""
RANGE_M = 6.0
"""Depth beyond which nothing is seen; such a pixel reads the range itself."""
FOCAL_PX = WIDTH / 2 / tan(radians(FIELD_OF_VIEW_DEG / 2))


def described() -> dict[str, float]:
    """Return what decides an image."""
    return {
        "width": WIDTH,
        "height": HEIGHT,
        "field_of_view_deg": FIELD_OF_VIEW_DEG,
        "range_m": RANGE_M,
    }


def mounted(rotation: Tensor) -> Tensor:
    """Return the camera's attitude `[3, 3, *b]` on a body of attitude `rotation`: its heading.

    From roots and quotients alone, which are rounded correctly: a lane's bits do not depend on the
    others. A body that points straight up has no heading; its camera looks along world x.
    """
    x, y = rotation[0, 0], rotation[1, 0]
    length = so3.root(x * x + y * y)
    up = length == 0
    c, s = torch.where(up, 1, x / length), torch.where(up, 0, y / length)
    zero, one = torch.zeros_like(c), torch.ones_like(c)
    return torch.stack((c, -s, zero, s, c, zero, zero, zero, one)).view(3, 3, *c.shape)


def slopes() -> tuple[Tensor, Tensor]:
    """Return how far the pixels' rays go left `[64]` and up `[36]` per metre forward, float64.

    Columns run from left to right and rows from top to bottom, so both fall.
    """
    left = (WIDTH - 1) / 2 - torch.arange(WIDTH, dtype=torch.float64)
    up = (HEIGHT - 1) / 2 - torch.arange(HEIGHT, dtype=torch.float64)
    return left / FOCAL_PX, up / FOCAL_PX


def rays() -> Tensor:
    """Return the ray through the centre of every pixel, `[3, 36, 64]`, float64, x = 1."""
    left, up = slopes()
    return torch.stack(
        (
            torch.ones(HEIGHT, WIDTH, dtype=torch.float64),
            left.expand(HEIGHT, WIDTH),
            up[:, None].expand(HEIGHT, WIDTH),
        )
    )


def captured(points: Tensor, position: Tensor, rotation: Tensor) -> Tensor:
    """Return world points `[3, S, N]` in capture frames at `[S, 3]` of attitudes `[S, 3, 3]`, m."""
    eye, axes = (part.movedim(0, -1).contiguous()[..., None] for part in (position, rotation))
    return so3.rotate_back(axes, points - eye)
