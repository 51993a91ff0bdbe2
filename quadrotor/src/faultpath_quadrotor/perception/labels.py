"""Clearance labels of a depth image: signed distance to the edge of the space known to be free.

The image is read as a surface: neighbouring pixels are joined by triangles. Where their depths are
close a triangle lies on a visible surface; where they jump it spans the gap along the rays, the
frontier between space seen to be free and hidden space. The two need no distinction: the
surface bounds the known free space. Behind it space counts as occupied, as in sdf-nmpc
(ntnu-arl/sdf-nmpc: a signed distance truncated to [-0.3, 1] m over one depth image). Triangles
whose corners all read the range are no surface: beyond the range space is free.

Outside the field of view only what is seen counts: the value is the positive distance to
the surface, and unseen space by itself costs nothing. Otherwise the vehicle could never turn,
and its own place, which no forward camera sees, would be occupied.
"""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from faultpath_quadrotor.perception.camera import FOCAL_PX, HEIGHT, RANGE_M, WIDTH, rays

LOWEST_M = -0.3
HIGHEST_M = 1.0

_SAMPLE_M = 0.15
"""Spacing of the points that find the triangles near a query."""
_NEIGHBOURS = 12
_NEAREST_DEPTH_M = 1e-3

Array = NDArray[np.float64]
_RAYS = rays().numpy()


def visible_distance(depth: Tensor, points: Tensor) -> Tensor:
    """Return the visible-space signed distance, `[N]`, m, float64, in [-0.3, 1].

    It is negative behind a visible surface or a frontier. `depth` is one image, z-depth `[36, 64]`,
    m; `points` are in the capture frame, `[3, N]`, m.
    """
    z = np.maximum(depth.double().numpy(), _NEAREST_DEPTH_M)
    at = points.double().numpy()
    distance = _surface_distance(z, at)
    signed = np.where(_behind(z, at), -distance, distance)
    return torch.from_numpy(signed.clip(LOWEST_M, HIGHEST_M))


def between_pixels(points: Tensor) -> Tensor:
    """Return whether points `[3, ...]` project between the outermost pixel centres, `[...]`."""
    x, y, z = points
    ahead = x > 0
    across = (y.abs() * FOCAL_PX) <= (WIDTH - 1) / 2 * x
    return ahead & across & ((z.abs() * FOCAL_PX) <= (HEIGHT - 1) / 2 * x)


def triangles(z: Array) -> Array:
    """Return the triangles of an image `[36, 64]`, `[T, 3 corners, 3]`, m."""
    corners = np.moveaxis(_RAYS * z, 0, -1)
    a, b = corners[:-1, :-1], corners[:-1, 1:]
    c, d = corners[1:, :-1], corners[1:, 1:]
    every = np.stack((np.stack((a, b, c), 2), np.stack((d, c, b), 2))).reshape(-1, 3, 3)
    return every[(every[:, :, 0] < RANGE_M).any(1)]


def _surface_distance(z: Array, points: Array) -> Array:
    """Return the distance to the nearest triangle, `[N]`; where it is beyond reach, more than 1 m.

    Points along each triangle's longest edge find the few triangles that may be nearest; the
    distance to those is exact.
    """
    from scipy.spatial import cKDTree  # slow to load, and only those who label need it

    surface = triangles(z)
    far = np.full(points.shape[1], np.inf)
    if not len(surface):
        return far
    samples, owner = _samples(surface)
    tree = cKDTree(samples, balanced_tree=False, compact_nodes=False)
    reach = HIGHEST_M + 2 * _SAMPLE_M
    index = np.asarray(
        tree.query(points.T, k=_NEIGHBOURS, distance_upper_bound=reach)[1], dtype=np.int64
    )
    query, slot = np.nonzero(index < len(samples))
    near = _triangle_distance(surface[owner[index[query, slot]]], points.T[query])
    np.minimum.at(far, query, near)
    return far


def _samples(corners: Array) -> tuple[Array, NDArray[np.int64]]:
    edges = np.roll(corners, -1, 1) - corners
    length = np.linalg.norm(edges, axis=2)
    longest = length.argmax(1)
    triangle = np.arange(len(corners))
    count = np.ceil(length[triangle, longest] / _SAMPLE_M).astype(np.int64).clip(1)
    owner = np.repeat(triangle, count)
    place = np.arange(len(owner)) - np.repeat(count.cumsum() - count, count)
    along = ((place + 0.5) / count[owner])[:, None]
    return corners[owner, longest[owner]] + along * edges[owner, longest[owner]], owner


def _triangle_distance(corners: Array, points: Array) -> Array:
    edges = np.roll(corners, -1, 1) - corners
    toward = points[:, None] - corners
    along = (toward * edges).sum(2) / np.maximum((edges * edges).sum(2), 1e-18)
    rest = toward - along.clip(0, 1)[..., None] * edges
    nearest = (rest * rest).sum(2).min(1)
    normal = np.cross(edges[:, 0], edges[:, 1])
    square = np.maximum((normal * normal).sum(1), 1e-18)
    inside = (np.cross(edges, toward) * normal[:, None]).sum(2).min(1) >= 0
    height = (toward[:, 0] * normal).sum(1) ** 2 / square
    return np.sqrt(np.where(inside, height, nearest))


def _behind(z: Array, points: Array) -> NDArray[np.bool_]:
    """Return whether points in view lie behind the surface.

    A plane's inverse depth is affine in the image, so inside a triangle it is the weighted mean of
    the corners' inverse depths.
    """
    seen = between_pixels(torch.from_numpy(points)).numpy()
    x, y, up = points[:, seen]
    column = (WIDTH - 1) / 2 - FOCAL_PX * y / x
    row = (HEIGHT - 1) / 2 - FOCAL_PX * up / x
    j = column.astype(np.int64).clip(0, WIDTH - 2)
    i = row.astype(np.int64).clip(0, HEIGHT - 2)
    right, down = column - j, row - i
    upper = right + down <= 1
    corner = np.where(upper, z[i, j], z[i + 1, j + 1])
    beside = np.where(upper, z[i, j + 1], z[i + 1, j])
    below = np.where(upper, z[i + 1, j], z[i, j + 1])
    right, down = np.where(upper, right, 1 - right), np.where(upper, down, 1 - down)
    inverse = (1 - right - down) / corner + right / beside + down / below
    surface = np.minimum(np.minimum(corner, beside), below) < RANGE_M
    behind = np.zeros(points.shape[1], dtype=bool)
    behind[seen] = surface & (x * inverse > 1)
    return behind
