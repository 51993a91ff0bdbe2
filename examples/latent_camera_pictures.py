"""Camera views of two rooms, and how errors of the camera are estimated and undone.

The pictures of `latent_camera.py`, which see the rooms from above.
"""

from typing import Literal

import torch
from torch.nn import functional

SIDE, RADIUS = 32, 2.0  # pixels
WALL, DOOR = (15.0, 17.0), (11.0, 21.0)  # from left to right, and from top to bottom
Rooms = Literal["marked", "blank"]


def between(value, low, high):
    """Return 1 where `value` is between, 0 where it is not, and a ramp one pixel wide."""
    return (value - low + 0.5).clamp(0, 1) * (high - value + 0.5).clamp(0, 1)


def picture(place, exposure, gamma, shift, smear, rooms):
    """Return `[n, 1, 32, 32]`: dots at `place` `[n, 2]`, as a camera with these numbers sees them.

    Without a place, the empty rooms. A pixel is where it is, to fractions: nothing is resampled.
    A smear mixes each pixel with those left and right of it, along its length in pixels.
    """
    grid = torch.arange(SIDE) + 0.5
    x, y = grid - shift[:, 0, None, None], grid[:, None] - shift[:, 1, None, None]
    light = torch.full((len(shift), SIDE, SIDE), 0.4)
    if rooms == "marked":
        wall = between(x, *WALL) * (1 - between(y, *DOOR))
        light = (0.3 + 0.006 * x + 0.004 * y) * (1 - 0.8 * wall)
        light = light * between(x, 1, SIDE - 1) * between(y, 1, SIDE - 1) + 0.02
    if place is not None:
        far = ((x - place[:, 0, None, None]) ** 2 + (y - place[:, 1, None, None]) ** 2).sqrt()
        dot = (RADIUS + 0.5 - far).clamp(0, 1)
        light = light * (1 - dot) + 0.85 * dot
    if smear.any():
        beside = torch.arange(-9, 10)  # pixels to the left and to the right
        share = (1 + smear.abs()[:, None] / 2 - beside.abs()).clamp(0, 1)
        rows = functional.pad(light, (9, 9), mode="replicate").unfold(2, 19, 1)
        light = (rows * share[:, None, None]).sum(dim=3) / share.sum(dim=1)[:, None, None]
    light = (exposure[:, None, None] * light).clamp(1e-4, 1)
    return (light ** gamma[:, None, None])[:, None]


class Rectified:
    """Estimates what a camera does to the marked rooms, by least squares, and undoes it."""

    def __init__(self):
        steps = torch.arange(-3, 3.01, 0.5)
        self.shifts = torch.cartesian_prod(steps, steps)
        one = torch.ones(len(self.shifts))
        self.empty = picture(None, one, one, self.shifts, 0 * one, "marked").flatten(1).log()

    def __call__(self, seen):
        light = seen.flatten().log()
        floor = (light <= light.quantile(0.97)).float()  # without the dot, which is brightest
        mean, empty = (floor * light).sum() / floor.sum(), self.empty @ floor / floor.sum()
        apart = (self.empty - empty[:, None]) * floor
        covariance, variance = apart @ (light - mean), apart.square().sum(dim=1)
        best = (covariance**2 / variance).argmax()
        light = empty[best] + (light - mean) * variance[best] / covariance[best]
        dot = (light.exp() - self.empty[best].exp()).view(1, 1, SIDE, SIDE)
        by = 2 * self.shifts[best] / SIDE
        back = torch.tensor([[[1.0, 0.0, by[0]], [0.0, 1.0, by[1]]]])
        where = functional.affine_grid(back, [1, 1, SIDE, SIDE], align_corners=False)
        rooms = self.empty[len(self.shifts) // 2].exp().view(1, 1, SIDE, SIDE)
        return (rooms + functional.grid_sample(dot, where, align_corners=False)).clamp(1e-4, 1)
