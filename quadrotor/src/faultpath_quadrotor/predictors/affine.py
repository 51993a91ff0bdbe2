"""A dense layer over few columns, compiled where no gradient flows."""

import torch
from torch import Tensor
from torch.nn import functional

from faultpath_quadrotor.native.kernel_args import lend, output
from faultpath_quadrotor.native.library import kernels_for


def affine(weight: Tensor, bias: Tensor, x: Tensor, gelu: bool = False) -> Tensor:
    """Return `weight @ x + bias` `[outputs, N]`, through a Gaussian error linear unit if asked.

    Args:
        weight: `[outputs, inputs]`.
        bias: `[outputs, 1]`.
        x: `[inputs, N]`.
        gelu: Whether the unit follows.
    """
    built = kernels_for(weight, bias, x)
    if built is None:
        y = torch.addmm(bias, weight, x)
        return functional.gelu(y) if gelu else y
    (outputs, inputs), columns = weight.shape, x.shape[1]
    filled = output(outputs, columns)
    built.call(
        "faultpath_affine",
        lend("weight", weight, outputs, inputs),
        lend("bias", bias, outputs, 1),
        lend("x", x, inputs, columns),
        *(outputs, inputs, columns, int(gelu), filled),
    )
    return filled.tensor
