"""Sine and cosine with the same bits on every processor.

Torch leaves both to a library that chooses its code by who made the processor.
"""

import torch
from torch import Tensor

from faultpath_quadrotor.native.kernel_args import lend, output
from faultpath_quadrotor.native.library import kernels_on

_NAMES = {torch.float32: "faultpath_sine_cosine_single", torch.float64: "faultpath_sine_cosine"}


def sine_cosine(angle: Tensor) -> tuple[Tensor, Tensor]:
    """Return sine and cosine of `angle`, rad, up to some thousands in size.

    Torch's own where gradients are enabled, as training goes.
    """
    built = None if torch.is_grad_enabled() else kernels_on(angle.device)
    if built is None or angle.dtype not in _NAMES:
        return angle.sin(), angle.cos()
    sine, cosine = (output(*angle.shape, dtype=angle.dtype) for _ in range(2))
    angles = lend("angle", angle, *angle.shape, dtype=angle.dtype)
    built.call(_NAMES[angle.dtype], angles, angle.numel(), sine, cosine)
    return sine.tensor, cosine.tensor
