"""The encoder of depth images, compiled."""

import ctypes
from collections.abc import Sequence

import torch
from torch import Tensor

from faultpath.quadrotor.native.lending import Lent, lend
from faultpath.quadrotor.native.library import Kernels

HEIGHT, WIDTH, CODE = 36, 64, 64
SHAPES = ((16, 2, 5, 5), (32, 16, 3, 3), (48, 32, 3, 3), (128, 48 * 5 * 8), (CODE, 128))
"""Of the weights: three convolutions and two dense layers; fixed in `encoder.cpp`, as is `CODE`."""

_LAYERS = ("first", "second", "third", "dense", "last")
_BLOCK = 32
"""Outputs of a dense layer that the kernel sums at once."""


class _Encoder(ctypes.Structure):
    """`Encoder` of `encoder.cpp`."""

    _fields_ = (
        *((name, ctypes.c_void_p) for name in _LAYERS),
        *((f"{name}_bias", ctypes.c_void_p) for name in _LAYERS),
        *((name, ctypes.c_float) for name in ("range", "nearest", "scale")),
    )


class CompiledEncoder:
    """Encodes depth images one by one, with a copy of the weights."""

    def __init__(
        self,
        kernels: Kernels,
        weights: Sequence[Tensor],
        biases: Sequence[Tensor],
        inputs: tuple[float, float, float],
    ) -> None:
        """Copy the weights.

        Args:
            kernels: What encodes.
            weights: Of `SHAPES`.
            biases: One for each output of each layer.
            inputs: A range r, a nearest depth n and a scale s: an image of depths d enters as d / r
                and as s / max(d, n).

        Raises:
            ValueError: A tensor is not what the kernel takes; see `lend`.
        """
        self._kernels = kernels
        parts = [
            (f"{kind} of layer {i}", tensor.detach(), shape)
            for kind, tensors, shapes in (
                ("weights", weights, SHAPES),
                ("biases", biases, [shape[:1] for shape in SHAPES]),
            )
            for i, (tensor, shape) in enumerate(zip(tensors, shapes, strict=True))
        ]
        for name, tensor, shape in parts:
            lend(name, tensor.contiguous(), *shape)
        *convolutions, dense, last = (tensor for _, tensor, _ in parts[: len(SHAPES)])
        # The kernel's features have their channels last, the model's flattened ones first.
        turned = dense.unflatten(1, (SHAPES[2][0], -1)).transpose(1, 2).flatten(1)
        laid = [weight.permute(2, 3, 1, 0) for weight in convolutions]
        laid += [w.unflatten(0, (-1, _BLOCK)).transpose(1, 2) for w in (turned, last)]
        laid += [tensor for _, tensor, _ in parts[len(SHAPES) :]]
        # The kernel holds addresses only.
        self._kept = [Lent(p.clone(memory_format=torch.contiguous_format)) for p in laid]
        self._table = _Encoder(*(part.address for part in self._kept), *inputs)

    def __call__(self, depth: Tensor) -> Tensor:
        """Return the codes `[64, S]` of images `[S, 36, 64]`, m.

        Raises `ValueError` for images of another size; see `lend`.
        """
        codes = torch.empty(CODE, len(depth))
        self._kernels.call(
            "faultpath_encode",
            ctypes.byref(self._table),
            lend("depth", depth.float().contiguous(), len(depth), HEIGHT, WIDTH),
            len(depth),
            lend("codes", codes, CODE, len(depth)),
        )
        return codes
