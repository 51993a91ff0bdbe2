"""Queries of the clearance model, compiled."""

import ctypes
from collections.abc import Sequence

import torch
from torch import Tensor

from faultpath.quadrotor.native.encoder import CompiledEncoder
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.perception.camera import FOCAL_PX, HEIGHT, WIDTH
from faultpath.quadrotor.perception.clearance import (
    NEAR_M,
    UNSEEN_M,
    ClearanceModel,
    DepthClearance,
)
from faultpath.quadrotor.perception.labels import HIGHEST_M, LOWEST_M


class _Bounds(ctypes.Structure):
    """`Bounds` of `clearance.cpp`."""

    _fields_ = tuple(
        (name, ctypes.c_float) for name in ("lowest", "highest", "unseen", "near", "left", "up")
    )


class CompiledDepthClearance(DepthClearance):
    """The same clearance, with frame, features, layers and field of view in one pass."""

    def __init__(self, kernels: Kernels, model: ClearanceModel) -> None:
        super().__init__(model)
        self._kernels = kernels
        self._encode = CompiledEncoder(kernels, model)
        self._bounds = _Bounds(
            LOWEST_M, HIGHEST_M, UNSEEN_M, NEAR_M**2, WIDTH / 2 / FOCAL_PX, HEIGHT / 2 / FOCAL_PX
        )
        self._networks: list[Tensor] = []
        self._eye = self._axes = torch.empty(0)

    @torch.no_grad()
    def capture(self, depth: Tensor, position: Tensor, rotation: Tensor) -> None:
        """See `DepthClearance.capture`; the query networks are made here, once a replan."""
        self._networks = self._model.networks(self._encode(depth))
        self._eye = position.float()
        self._axes = rotation.float().flatten(1)

    @torch.no_grad()
    def query(self, points: Tensor, scenes: Sequence[int]) -> Tensor:
        """See `DepthClearance.query`."""
        if not self._networks:
            raise RuntimeError("nothing was captured yet: call `capture` before `query`")
        chosen = torch.as_tensor(scenes)
        clearance = points.new_empty(points.shape[1:])
        parts = (*self._networks, self._eye, self._axes)
        self._kernels.call(
            "faultpath_clearance",
            ctypes.byref(self._bounds),
            *(part.index_select(0, chosen) for part in parts),
            *(points.contiguous(), *points.shape[1:], clearance),
        )
        return clearance
