"""Queries of the clearance that a depth image's code stands for, compiled."""

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import Tensor

from faultpath.quadrotor.native.encoder import CODE
from faultpath.quadrotor.native.lending import Block, fields, lend
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.native.packing import BLOCK, pack

FEATURES, HIDDEN = 8, 47
"""Fixed in `clearance.cpp`, without the constants that carry the biases."""
SHAPES = ((HIDDEN, FEATURES + 1), (HIDDEN, HIDDEN + 1), (1, HIDDEN + 1))
"""Outputs and inputs of the layers of a query network; the last input is the bias."""

_NUMBERS = (FEATURES + 1 + HIDDEN + 1 + 1) * (HIDDEN + 1)
"""Numbers of a query network (`Query` in `clearance.cpp`)."""


class Bounds(NamedTuple):
    """Between what the answer lies, and where the image covers what is asked."""

    lowest_m: float
    highest_m: float
    unseen_m: float
    """Most clearance where no pixel looks."""
    near_m: float
    """Distance within which that does not matter."""
    left: float
    """Half the image's width, per metre forward."""
    up: float


class _Bounds(Block):
    """`Bounds` of `clearance.cpp`."""

    _fields_ = fields(ctypes.c_float, "lowest highest unseen near left up")


class CompiledClearance:
    """Capture frame, features, query network and field of view in one pass."""

    def __init__(self, kernels: Kernels, makers: Sequence[Tensor], bounds: Bounds) -> None:
        """Copy what makes a query network from a code.

        Args:
            kernels: What answers.
            makers: For each layer of `SHAPES`, `[outputs * inputs, 64 + 1]`: a column for each
                number of the code, and what is there without any.
            bounds: What the answer keeps to.
        """
        self._kernels = kernels
        self._bounds = _Bounds(*bounds._replace(near_m=bounds.near_m**2))
        rows: list[Tensor] = []
        for made, (outputs, inputs) in zip(makers, SHAPES, strict=True):
            lend("makers", made.detach().contiguous(), outputs * inputs, CODE + 1)
            # Numbers stand in the order of `Query`: hidden layers in blocks of outputs, biases
            # first, padded with zeros; the last layer as it is.
            whole = made.detach().unflatten(0, (outputs, inputs))
            if outputs > 1:
                whole = pack(whole.roll(1, dims=1), BLOCK)
            rows.append(whole.reshape(-1, CODE + 1))
        numbers = torch.cat(rows).T.contiguous()
        self._makers = lend("makers", numbers[:-1].contiguous(), CODE, _NUMBERS)
        self._base = lend("base", numbers[-1].contiguous(), _NUMBERS)

    def __call__(self, codes: Tensor, eye: Tensor, axes: Tensor, points: Tensor) -> Tensor:
        """Return the clearance `[S, N]`, m.

        Args:
            codes: `[64, S]`.
            eye: Where the images were taken from, `[S, 3]`, m.
            axes: And the camera's attitudes, `[S, 3, 3]`.
            points: World frame, `[3, S, N]`, m.
        """
        _, scenes, count = points.shape
        clearance = points.new_empty(scenes, count)
        self._kernels.call(
            "faultpath_clearance",
            *(self._bounds, self._makers, self._base),
            lend("codes", codes.contiguous(), CODE, scenes),
            lend("position", eye.contiguous(), scenes, 3),
            lend("rotation", axes.contiguous(), scenes, 3, 3),
            lend("points", points.contiguous(), 3, scenes, count),
            *(scenes, count),
            lend("clearance", clearance, scenes, count),
        )
        return clearance
