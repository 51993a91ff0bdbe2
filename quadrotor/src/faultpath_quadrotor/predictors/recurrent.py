"""A gated recurrent unit over a sequence, compiled."""

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import as_kernel_argument
from faultpath_quadrotor.native.library import Kernels

LATENT = 32
GATES = 3 * LATENT
MOST_INPUTS = 32
"""Fixed in `recurrent.cpp`."""


def fits(inputs: int, latent: int) -> bool:
    """Return whether the kernel has room for a cell of this size."""
    return 0 < inputs <= MOST_INPUTS and latent == LATENT


def recur(
    kernels: Kernels,
    from_input: tuple[Tensor, Tensor],
    from_latent: tuple[Tensor, Tensor],
    sequence: Tensor,
) -> Tensor:
    """Return the latent `[32, N]` after a sequence, from zero.

    Args:
        kernels: Compiled kernels.
        from_input: Weights `[96, inputs]` and biases of the inputs' layer; at most 32 inputs.
        from_latent: Weights `[96, 32]` and biases of the latent's layer.
        sequence: `[T, inputs, N]`, float32.

    Raises:
        ValueError: There are more inputs.
    """
    steps, inputs, columns = sequence.shape
    if not fits(inputs, LATENT):
        raise ValueError(f"the recurrent kernel takes 1 to {MOST_INPUTS} inputs, not {inputs}")
    latent = torch.empty(LATENT, columns)
    (weights, biases), (kept_weights, kept_biases) = (
        (weight.detach(), bias.detach()) for weight, bias in (from_input, from_latent)
    )
    kernels.call(
        "faultpath_recur",
        as_kernel_argument("weights of the inputs", weights, GATES, inputs),
        as_kernel_argument("biases of the inputs", biases, GATES, 1),
        as_kernel_argument("weights of the latent", kept_weights, GATES, LATENT),
        as_kernel_argument("biases of the latent", kept_biases, GATES, 1),
        as_kernel_argument("sequence", sequence.contiguous(), steps, inputs, columns),
        *(steps, inputs, columns),
        as_kernel_argument("latent", latent, LATENT, columns),
    )
    return latent
