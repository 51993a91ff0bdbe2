"""How dense layers lie in memory for `layers.hpp`."""

import torch
from torch import Tensor

BLOCK = 4
"""Outputs that a kernel sums at once (`OUTPUTS` in `layers.hpp`); weights lie in such blocks."""


def pack(weights: Tensor, block: int) -> Tensor:
    """Return `[outputs, 1 + inputs, ...]` as `[blocks, 1 + inputs, block, ...]`.

    Biases come first among the inputs; outputs are padded with zeros to whole blocks.
    """
    missing = -len(weights) % block
    padded = torch.cat((weights, weights.new_zeros(missing, *weights.shape[1:])))
    return padded.unflatten(0, (-1, block)).transpose(1, 2).contiguous()
