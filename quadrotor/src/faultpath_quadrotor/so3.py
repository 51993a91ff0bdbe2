"""Rotations as matrices, components first and batch last: [3, 3, *b], body to world.

Products are sums of broadcast products, which vectorise over the batch; `bmm` and `einsum` want
the batch first and are several times slower on the planner's shapes. Everything but `project`
is differentiable, also at the identity.
"""

import numpy as np
import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import lend, output
from faultpath_quadrotor.native.library import kernels_on


def root(square: Tensor) -> Tensor:
    """Return the square root, rounded correctly and so alike on every processor.

    Torch leaves it to a library that begins with the processor's own approximation. Torch's own
    where gradients are enabled, as training goes.
    """
    if torch.is_grad_enabled() or square.device.type != "cpu":
        return square.sqrt()
    return torch.from_numpy(np.asarray(np.sqrt(square.numpy())))


_NAMES = {torch.float32: "faultpath_sine_cosine_single", torch.float64: "faultpath_sine_cosine"}


def sine_cosine(angle: Tensor) -> tuple[Tensor, Tensor]:
    """Return sine and cosine of `angle`, rad, up to some thousands in size.

    They have the same bits on every processor; torch leaves both to a library that chooses its code
    by who made it. Torch's own where gradients are enabled, as training goes.
    """
    built = None if torch.is_grad_enabled() else kernels_on(angle.device)
    if built is None or angle.dtype not in _NAMES:
        return angle.sin(), angle.cos()
    sine, cosine = (output(*angle.shape, dtype=angle.dtype) for _ in range(2))
    angles = lend("angle", angle, *angle.shape, dtype=angle.dtype)
    built.call(_NAMES[angle.dtype], angles, angle.numel(), sine, cosine)
    return sine.tensor, cosine.tensor


# Added to a squared angle before its root: far below what either dtype can resolve next to an
# angle that matters, it keeps 0/0 and the root's infinite slope out of the identity.
_TINY = 1e-24

_SQUARINGS = 10
"""Enough for matrices whose nearest rotation is not in doubt: what is a 0.98th of the leading
eigenvalue is a billionth of it after ten."""


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
    angle = root((phi * phi).sum(0).add_(_TINY))
    s, c = sine_cosine(angle * 0.5)
    return _from_quaternion(c, phi * (s / angle), (c * c).addcmul_(s, s, value=-1.0))


def _from_quaternion(c: Tensor, q: Tensor, cos: Tensor) -> Tensor:
    doubled = q + q
    skew = doubled * c
    x, y, z = skew.unbind(0)
    nx, ny, nz = skew.neg().unbind(0)
    rest = torch.stack((cos, nz, y, z, cos, nx, ny, x, cos)).view(3, *q.shape)
    return rest.addcmul_(doubled.unsqueeze(1), q)


def log(rotation: Tensor) -> Tensor:
    """Return the rotation vector in rad, [3, *b], of norm at most pi: the inverse of `exp`.

    Through the quaternion read from the best conditioned of its four columns (Shepperd 1978),
    so that it is accurate near 0 and near pi alike.
    """
    quaternion = _safest_row(_outer(rotation))
    quaternion = torch.where(quaternion[0] < 0, -quaternion, quaternion)
    scalar, vector = quaternion[0], quaternion[1:]
    norm = root((vector * vector).sum(0) + _TINY)
    return vector * (2.0 * torch.atan2(norm, scalar) / norm)


def _outer(r: Tensor) -> Tensor:
    """Return four times the outer product of a rotation's quaternion with itself, [4, 4, *b].

    Of any matrix it is a linear map: the identity and the matrix whose leading eigenvector is the
    quaternion of the nearest rotation (Horn 1987).
    """
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    x, y, z = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    xy, xz, yz = r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1]
    w, a, b, c = [1 + trace] + [1 - trace + 2 * r[i, i] for i in range(3)]
    rows = torch.stack([w, x, y, z, x, a, xy, xz, y, xy, b, yz, z, xz, yz, c])
    return rows.view(4, 4, *trace.shape)


def _safest_row(outer: Tensor) -> Tensor:
    best = torch.stack([outer[i, i] for i in range(4)]).argmax(0)
    return outer.gather(0, best.expand(1, *outer.shape[1:]))[0]


def from_yaw(yaw: Tensor) -> Tensor:
    """Return level attitudes of heading `yaw` [*b] rad about the world's z; [3, 3, *b]."""
    s, c = sine_cosine(yaw)
    zero, one = torch.zeros_like(yaw), torch.ones_like(yaw)
    return torch.stack((c, -s, zero, s, c, zero, zero, zero, one)).view(3, 3, *yaw.shape)


def heading(rotation: Tensor) -> Tensor:
    """Return the direction of the body's x axis about the world's z, rad, [*b]."""
    return torch.atan2(rotation[1, 0], rotation[0, 0])


def skew(vector: Tensor) -> Tensor:
    """Return the matrix that takes the cross product with `vector` [3, *b]; [3, 3, *b]."""
    x, y, z = vector.unbind(0)
    zero = torch.zeros_like(x)
    return torch.stack((zero, -z, y, z, zero, -x, -y, x, zero)).view(3, *vector.shape)


def project(matrix: Tensor) -> Tensor:
    """Return the rotation nearest to `matrix` [3, 3, *b] in the Frobenius norm.

    Through the quaternion, in steps that are the same for any matrix: no device is waited for, and
    no library chooses its way. The norm added to Horn's matrix makes its eigenvalues positive with
    the leading one the largest; each squaring then squares the ratio of the others to it, until its
    projector alone is left.
    """
    one = torch.eye(4, dtype=matrix.dtype, device=matrix.device)
    one = one.view(4, 4, *(1,) * (matrix.ndim - 2))
    horn = _outer(matrix) - one
    power = horn + (root(horn.square().sum((0, 1))) + _TINY) * one
    for _ in range(_SQUARINGS):
        power = power / (power * one).sum((0, 1))
        power = compose(power, power)
    quaternion = _safest_row(power)
    quaternion = quaternion / root(quaternion.square().sum(0))
    c, q = quaternion[0], quaternion[1:]
    return _from_quaternion(c, q, c * c - (q * q).sum(0))
