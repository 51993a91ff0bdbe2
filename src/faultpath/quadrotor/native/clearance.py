"""Queries of the clearance model, compiled."""

import ctypes
from collections.abc import Sequence

import torch
from torch import Tensor

from faultpath.quadrotor.native.encoder import CompiledEncoder, misfit
from faultpath.quadrotor.native.lending import Lent, lend
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.native.packing import BLOCK, pack
from faultpath.quadrotor.perception.camera import FOCAL_PX, HEIGHT, WIDTH
from faultpath.quadrotor.perception.clearance import (
    CODE,
    HIDDEN,
    NEAR_M,
    UNSEEN_M,
    ClearanceModel,
    DepthClearance,
)
from faultpath.quadrotor.perception.labels import HIGHEST_M, LOWEST_M

_NUMBERS = (9 + HIDDEN + 1) * HIDDEN
"""Numbers of a query network (`Query` in `clearance.cpp`): two hidden layers, and the last."""


class _Bounds(ctypes.Structure):
    """`Bounds` of `clearance.cpp`."""

    _fields_ = tuple(
        (name, ctypes.c_float) for name in ("lowest", "highest", "unseen", "near", "left", "up")
    )


class CompiledDepthClearance(DepthClearance):
    """The same clearance, with frame, features, layers and field of view in one pass.

    Raises `ValueError` for a model of another form, or points and images of another size.
    """

    def __init__(self, kernels: Kernels, model: ClearanceModel) -> None:
        super().__init__(model)
        self._kernels = kernels
        self._encode = CompiledEncoder(kernels, model)
        self._bounds = _Bounds(
            LOWEST_M, HIGHEST_M, UNSEEN_M, NEAR_M**2, WIDTH / 2 / FOCAL_PX, HEIGHT / 2 / FOCAL_PX
        )
        self._makers, self._base = _makers(model)
        self._codes: Tensor | None = None
        self._eye = self._axes = torch.empty(0)

    @staticmethod
    def misfit(model: ClearanceModel) -> str:
        """Return in words why there is no compiled form of a model; empty if there is."""
        return misfit(model)

    @torch.no_grad()
    def capture(self, depth: Tensor, position: Tensor, rotation: Tensor) -> None:
        """See `DepthClearance.capture`."""
        self._codes = self._encode(depth)
        self._eye = position.float()
        self._axes = rotation.float().flatten(1)

    @torch.no_grad()
    def query(self, points: Tensor, scenes: Sequence[int] | Tensor) -> Tensor:
        """See `DepthClearance.query`."""
        if self._codes is None:
            raise RuntimeError("nothing was captured yet: call `capture` before `query`")
        chosen = torch.as_tensor(scenes)
        scenes_asked, count = len(chosen), points.shape[-1]
        clearance = points.new_empty(points.shape[1:])
        self._kernels.call(
            "faultpath_clearance",
            *(ctypes.byref(self._bounds), self._makers, self._base),
            lend("codes", self._codes.index_select(1, chosen), CODE, scenes_asked),
            lend("position", self._eye.index_select(0, chosen), scenes_asked, 3),
            lend("rotation", self._axes.index_select(0, chosen), scenes_asked, 9),
            lend("points", points.contiguous(), 3, scenes_asked, count),
            *(scenes_asked, count),
            lend("clearance", clearance, scenes_asked, count),
        )
        return clearance


@torch.no_grad()
def _makers(model: ClearanceModel) -> tuple[Lent, Lent]:
    """Return what makes a query network from a code: `[64, n]` and `[n]`.

    The network's numbers stand in the order of `Query` in `clearance.cpp`: hidden layers in blocks
    of outputs, biases first, padded with zeros; the last layer as it is.
    """
    rows: list[Tensor] = []
    for layer, (outputs, inputs) in model.makers():
        whole = torch.cat((layer.weight, layer.bias[:, None]), 1).unflatten(0, (outputs, inputs))
        if outputs > 1:
            whole = pack(whole.roll(1, dims=1), BLOCK)
        rows.append(whole.reshape(-1, whole.shape[-1]))
    made = torch.cat(rows).T.contiguous()
    weights = lend("makers", made[:-1].contiguous(), CODE, _NUMBERS)
    return weights, lend("base", made[-1].contiguous(), _NUMBERS)
