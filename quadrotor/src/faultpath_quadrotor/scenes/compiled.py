"""Queries of a baked distance field, compiled."""

import ctypes

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import Block, as_kernel_argument, fields
from faultpath_quadrotor.native.library import Kernels


class _Field(Block):
    """`Field` of `field.cpp`."""

    _fields_ = (
        ("table", ctypes.c_void_p),
        *fields(ctypes.c_int64, "along_x along_y"),
        *fields(ctypes.c_void_p, "origin last first"),
        ("per_metre", ctypes.c_float),
    )


class CompiledField:
    """Interpolates the table of some scenes; the arguments are attributes of `DistanceField`.

    Raises `ValueError` where a scene's cells lie outside the table.
    """

    def __init__(
        self,
        kernels: Kernels,
        table: Tensor,
        pitch: tuple[int, int, int],
        origin: Tensor,
        last: Tensor,
        first: Tensor,
        per_metre: float,
    ) -> None:
        self._kernels = kernels
        self._scenes = len(first)
        self._field = _Field(
            as_kernel_argument("table", table, table.numel()),
            *pitch[:2],
            as_kernel_argument("origin", origin.contiguous(), 3, self._scenes, 1),
            as_kernel_argument("last", last.contiguous(), 3, self._scenes, 1),
            as_kernel_argument("first", first.contiguous(), self._scenes, 1, dtype=torch.int32),
            per_metre,
        )
        _check_places(len(table), pitch, last, first)

    def query(self, points: Tensor) -> Tensor:
        """Return the distance `[B, N]` at `points` `[3, B, N]`, float32, m."""
        _, scenes, count = points.shape
        if scenes != self._scenes:
            points = points.expand(3, self._scenes, count)
        distances = torch.empty(points.shape[1:])
        self._kernels.call(
            "faultpath_field",
            self._field,
            as_kernel_argument("points", points.float().contiguous(), 3, self._scenes, count),
            *(self._scenes, count),
            as_kernel_argument("distances", distances, self._scenes, count),
        )
        return distances


def _check_places(length: int, pitch: tuple[int, int, int], last: Tensor, first: Tensor) -> None:
    """Raise `ValueError` unless every corner of every cell stands in a table of `length`."""
    steps = torch.tensor(pitch, dtype=torch.float64)[:, None, None]
    furthest = (last * steps).sum(0) + first + sum(pitch)
    inside = (first >= 0) & (last >= 0).all(0) & (furthest < length)
    if pitch[2] != 1 or min(pitch) < 1 or not bool(inside.all()):
        raise ValueError(f"distance field: cells of pitch {pitch} lie outside its table")
