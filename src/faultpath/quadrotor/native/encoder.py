"""The encoder of depth images, compiled."""

import ctypes
from collections.abc import Sequence

import torch
from torch import Tensor

from faultpath.quadrotor.native.lending import Block, Lent, fields, lend
from faultpath.quadrotor.native.library import Kernels

HEIGHT, WIDTH, CODE = 36, 64, 64
SHAPES = ((16, 2, 5, 5), (32, 16, 3, 3), (48, 32, 3, 3), (128, 48 * 5 * 8), (CODE, 128))
"""Of the weights: three convolutions and two dense layers; fixed in `encoder.cpp`, as is `CODE`."""

_BLOCK = 32
"""Outputs of a dense layer that the kernel sums at once."""


class _Encoder(Block):
    """`Encoder` of `encoder.cpp`."""

    _fields_ = (
        *fields(ctypes.c_void_p, "first second third dense last"),
        *fields(ctypes.c_void_p, "first_bias second_bias third_bias dense_bias last_bias"),
        *fields(ctypes.c_float, "range nearest scale"),
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
        """
        self._kernels = kernels
        for i, (shape, weight, bias) in enumerate(zip(SHAPES, weights, biases, strict=True)):
            lend(f"weights of layer {i}", weight.detach().contiguous(), *shape)
            lend(f"biases of layer {i}", bias.detach().contiguous(), shape[0])
        *convolutions, dense, last = (weight.detach() for weight in weights)
        # The kernel's features have their channels last, the model's flattened ones first.
        turned = dense.unflatten(1, (SHAPES[2][0], -1)).transpose(1, 2).flatten(1)
        laid = [weight.permute(2, 3, 1, 0) for weight in convolutions]
        laid += [w.unflatten(0, (-1, _BLOCK)).transpose(1, 2) for w in (turned, last)]
        laid += [bias.detach() for bias in biases]
        copies = [Lent(part.clone(memory_format=torch.contiguous_format)) for part in laid]
        self._table = _Encoder(*copies, *inputs)

    def __call__(self, depth: Tensor) -> Tensor:
        """Return the codes `[64, S]` of images `[S, 36, 64]`, m."""
        codes = torch.empty(CODE, len(depth))
        self._kernels.call(
            "faultpath_encode",
            self._table,
            lend("depth", depth.float().contiguous(), len(depth), HEIGHT, WIDTH),
            len(depth),
            lend("codes", codes, CODE, len(depth)),
        )
        return codes
