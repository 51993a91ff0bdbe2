"""The encoder of depth images, compiled."""

import ctypes

import torch
from torch import Tensor, nn

from faultpath.quadrotor.device import at_hand
from faultpath.quadrotor.native.lending import is_exactly, lend, unlike
from faultpath.quadrotor.native.library import Kernels
from faultpath.quadrotor.perception.camera import HEIGHT, RANGE_M, WIDTH
from faultpath.quadrotor.perception.clearance import CODE, INVERSE_SCALE, NEAREST_M, ClearanceModel

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


def misfit(model: ClearanceModel) -> str:
    """Return in words why the kernels of clearance do not stand for a model; empty if they do."""
    if not is_exactly(model, ClearanceModel):
        return unlike(ClearanceModel, model)
    with torch.device("meta"):
        known = ClearanceModel()
    kinds = [type(part) for part in known.modules()]
    parts = list(model.modules())
    if len(parts) != len(kinds) or not all(map(is_exactly, parts, kinds)):
        return "its layers are others"
    theirs = {name: part.shape for name, part in known.state_dict().items()}
    if str(model) != str(known) or theirs != {n: p.shape for n, p in model.state_dict().items()}:
        return "its layers have other sizes"
    if any(p.dtype != torch.float32 or not at_hand(p.device) for p in model.parameters()):
        return "its weights are not float32 on the CPU"
    return ""


class CompiledEncoder:
    """Encodes depth images one by one, with the weights that a model has when this is made."""

    @torch.no_grad()
    def __init__(self, kernels: Kernels, model: ClearanceModel) -> None:
        """Copy the weights; raises `ValueError` for a model of another form, see `misfit`."""
        if wrong := misfit(model):
            raise ValueError(f"no compiled encoder of this model: {wrong}")
        self._kernels = kernels
        modules = [m for m in model.encoder if isinstance(m, nn.Conv2d | nn.Linear)]
        *convolutions, dense, last = (module.weight for module in modules)
        third = convolutions[-1].shape[0]
        # The kernel's features have their channels last, the model's flattened ones first.
        turned = dense.unflatten(1, (third, -1)).transpose(1, 2).flatten(1)
        weights = [weight.permute(2, 3, 1, 0) for weight in convolutions]
        weights += [w.unflatten(0, (-1, _BLOCK)).transpose(1, 2) for w in (turned, last)]
        biases = [module.bias for module in modules]
        # The kernel holds addresses only.
        parts = [*weights, *(bias for bias in biases if bias is not None)]
        self._kept = [p.detach().clone(memory_format=torch.contiguous_format) for p in parts]
        addresses = [part.data_ptr() for part in self._kept]
        self._table = _Encoder(*addresses, RANGE_M, NEAREST_M, INVERSE_SCALE)

    def __call__(self, depth: Tensor) -> Tensor:
        """Return the codes `[64, S]` of images `[S, 36, 64]`, m; see `ClearanceModel.encode`.

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
