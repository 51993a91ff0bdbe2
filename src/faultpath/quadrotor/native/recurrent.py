"""A gated recurrent unit over a sequence, compiled."""

import torch
from torch import Tensor

from faultpath.quadrotor.native.library import Kernels

LATENT = 32
MOST_INPUTS = 32
"""Fixed in `recurrent.cpp`."""


def recur(
    kernels: Kernels,
    given: tuple[Tensor, Tensor],
    kept: tuple[Tensor, Tensor],
    sequence: Tensor,
) -> Tensor:
    """Return the latent `[32, N]` after a sequence, from zero.

    Args:
        kernels: Compiled kernels.
        given: Weights `[96, inputs]` and biases of the inputs' layer; at most 32 inputs.
        kept: Weights `[96, 32]` and biases of the latent's layer.
        sequence: `[T, inputs, N]`, float32.
    """
    steps, inputs, columns = sequence.shape
    assert inputs <= MOST_INPUTS
    latent = torch.empty(LATENT, columns)
    layers = (part.detach() for part in (*given, *kept))
    kernels.call(
        "faultpath_recur", *layers, sequence.contiguous(), *(steps, inputs, columns), latent
    )
    return latent
