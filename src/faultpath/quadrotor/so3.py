"""Rotations as matrices, components first and batch last: [3, 3, *b], body to world.

Products are sums of broadcast products, which vectorise over the batch; `bmm` and `einsum` want
the batch first and are several times slower on the planner's shapes. Everything but `project`
is differentiable, also at the identity.
"""

import torch
from torch import Tensor

# Added to a squared angle before its root: far below what either dtype can resolve next to an
# angle that matters, it keeps 0/0 and the root's infinite slope out of the identity.
_TINY = 1e-24


def compose(first: Tensor, second: Tensor) -> Tensor:
    """Return the product `first @ second`, [3, 3, *b] each; batch shapes may broadcast."""
    return (first.unsqueeze(2) * second).sum(1)


def rotate(rotation: Tensor, vector: Tensor) -> Tensor:
    """Return R v: a body-frame `vector` [3, *b] in the world frame."""
    return (rotation * vector).sum(1)


def rotate_back(rotation: Tensor, vector: Tensor) -> Tensor:
    """Return R^T v: a world-frame `vector` [3, *b] in the body frame."""
    return (rotation * vector.unsqueeze(1)).sum(0)


def exp(phi: Tensor) -> Tensor:
    """Return the rotation by |phi| rad about phi, for `phi` [3, *b]; [3, 3, *b].

    Rodrigues' formula through half angles, exp = cos(t) I + 2 c [q]x + 2 q q^T with t = |phi|,
    q = phi sin(t/2)/t and c = cos(t/2): no quotient of cancelled numbers at small angles.
    """
    angle = (phi * phi).sum(0).add_(_TINY).sqrt_()
    half = angle * 0.5
    s, c = half.sin(), half.cos()
    q = phi * (s / angle)
    doubled = q + q
    skew = doubled * c
    x, y, z = skew.unbind(0)
    nx, ny, nz = skew.neg().unbind(0)
    cos = (c * c).addcmul_(s, s, value=-1.0)
    rest = torch.stack((cos, nz, y, z, cos, nx, ny, x, cos)).view(3, *phi.shape)
    return rest.addcmul_(doubled.unsqueeze(1), q)


def log(rotation: Tensor) -> Tensor:
    """Return the rotation vector in rad, [3, *b], of norm at most pi: the inverse of `exp`.

    Through the quaternion read from the best conditioned of its four columns (Shepperd 1978),
    so that it is accurate near 0 and near pi alike.
    """
    r = rotation
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    x, y, z = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    xy, xz, yz = r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1]
    squares = [1 + trace] + [1 - trace + 2 * r[i, i] for i in range(3)]
    w, a, b, c = squares
    # Four times the outer product of the quaternion (w, x, y, z) with itself: every row is
    # the quaternion up to a factor; the one with the largest diagonal is the safest.
    outer = torch.stack([w, x, y, z, x, a, xy, xz, y, xy, b, yz, z, xz, yz, c])
    outer = outer.view(4, 4, *trace.shape)
    best = torch.stack(squares).argmax(0).expand(1, 4, *trace.shape)
    quaternion = outer.gather(0, best)[0]
    quaternion = torch.where(quaternion[0] < 0, -quaternion, quaternion)
    scalar, vector = quaternion[0], quaternion[1:]
    norm = ((vector * vector).sum(0) + _TINY).sqrt()
    return vector * (2.0 * torch.atan2(norm, scalar) / norm)


def from_yaw(yaw: Tensor) -> Tensor:
    """Return level attitudes of heading `yaw` [*b] rad about the world's z; [3, 3, *b]."""
    c, s = yaw.cos(), yaw.sin()
    zero, one = torch.zeros_like(yaw), torch.ones_like(yaw)
    return torch.stack((c, -s, zero, s, c, zero, zero, zero, one)).view(3, 3, *yaw.shape)


def project(matrix: Tensor) -> Tensor:
    """Return the rotation nearest to `matrix` [3, 3, *b] in the Frobenius norm."""
    u, _, vh = torch.linalg.svd(matrix.movedim((0, 1), (-2, -1)))
    sign = torch.linalg.det(u @ vh)
    u = torch.cat((u[..., :2], u[..., 2:] * sign[..., None, None]), dim=-1)
    return (u @ vh).movedim((-2, -1), (0, 1)).contiguous()
