"""Queries of a baked distance field, compiled."""

import ctypes

import torch
from torch import Tensor

from faultpath.quadrotor.native.library import Kernels


class _Field(ctypes.Structure):
    """`Field` of `field.cpp`."""

    _fields_ = (
        ("table", ctypes.c_void_p),
        ("along_x", ctypes.c_int64),
        ("along_y", ctypes.c_int64),
        ("origin", ctypes.c_void_p),
        ("last", ctypes.c_void_p),
        ("first", ctypes.c_void_p),
        ("per_metre", ctypes.c_float),
    )


class CompiledField:
    """Interpolates the table of some scenes; the arguments are attributes of `DistanceField`."""

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
        self._kept = (table, origin.contiguous(), last.contiguous(), first.contiguous())
        places = [part.data_ptr() for part in self._kept]
        self._scenes = len(first)
        self._field = _Field(places[0], pitch[0], pitch[1], *places[1:], per_metre)

    def query(self, points: Tensor) -> Tensor:
        """Return the distance `[B, N]` at `points` `[3, B, N]`, float32, m."""
        _, scenes, count = points.shape
        if scenes != self._scenes:
            points = points.expand(3, self._scenes, count)
        distances = torch.empty(points.shape[1:])
        self._kernels.call(
            "faultpath_field",
            ctypes.byref(self._field),
            points.float().contiguous(),
            *distances.shape,
            distances,
        )
        return distances
