"""Memory lent to a compiled kernel: what the kernel assumes is checked here, in code.

A kernel gets an address and trusts the rest: a tensor of another size, precision, device or layout
would be read as garbage, or past its end. So every function and object of this package raises
`ValueError` for a tensor that its kernel does not take.
"""

import ctypes
import warnings
from dataclasses import dataclass
from functools import cache
from typing import TypeGuard, TypeVar

import torch
from torch import Tensor

from faultpath.plugin.system import Notice
from faultpath_quadrotor.device import host_readable

T = TypeVar("T")


class PortableNotice(Notice):
    """A part has no compiled form, or not of its size: it runs as it is, more slowly."""


@cache
def tell_portable(what: str, why: str) -> None:
    """Say, once a process, that `what` runs on the portable path, and why."""
    warnings.warn(
        f"{what} runs on the portable path, several times slower than a compiled kernel: {why}.",
        PortableNotice,
        stacklevel=3,
    )


@dataclass(frozen=True)
class Lent:
    """A tensor that a kernel reads or writes, checked; held for as long as its address is used."""

    tensor: Tensor

    @property
    def address(self) -> ctypes.c_void_p:
        """Where its first number stands."""
        return ctypes.c_void_p(self.tensor.data_ptr())


def lend(name: str, tensor: Tensor, *shape: int, dtype: torch.dtype = torch.float32) -> Lent:
    """Return `tensor`, copied where it is not contiguous, for a kernel that takes `shape` and
    `dtype` for granted.

    Raises:
        ValueError: It has another shape or dtype, is not in the host's memory or not dense, or a
            gradient should flow through it; names what is wrong and what to do.
    """
    wrong = (
        f"has the shape {list(tensor.shape)}, not {list(shape)}: give it that shape"
        if tensor.shape != shape
        else f"is {_short(tensor.dtype)}, not {_short(dtype)}: convert it"
        if tensor.dtype != dtype
        else f"is on {tensor.device}, not on the CPU: move it"
        if not host_readable(tensor.device)
        else "is not dense: call `to_dense()`"
        if tensor.layout is not torch.strided
        else "should have a gradient, which no kernel passes on: detach it, or roll out in torch"
        if tensor.requires_grad and torch.is_grad_enabled()
        else ""
    )
    if wrong:
        raise ValueError(
            f"compiled kernel: '{name}' {wrong}; FAULTPATH_KERNELS=portable runs without kernels"
        )
    return Lent(tensor.contiguous().resolve_neg())


def output(*shape: int, dtype: torch.dtype = torch.float32) -> Lent:
    """Return memory that a kernel fills."""
    return Lent(torch.empty(shape, dtype=dtype))


class Block(ctypes.Structure):
    """A structure that a kernel reads; it holds on to what its addresses point to."""

    def __init__(self, *values: object, **named: object) -> None:
        self._values = (values, named)
        super().__init__(
            *map(_written, values), **{name: _written(value) for name, value in named.items()}
        )


def _written(value: object) -> object:
    return value.address if isinstance(value, Lent) else value


def fields(kind: type, names: str) -> tuple[tuple[str, type], ...]:
    """Return fields of one type for a `Block`, from their names in a row."""
    return tuple((name, kind) for name in names.split())


BLOCK = 4
"""Outputs that a kernel sums at once (`OUTPUTS` in `layers.hpp`); weights lie in such blocks."""


def pack(weights: Tensor, block: int) -> Tensor:
    """Return `[outputs, 1 + inputs, ...]` as `[blocks, 1 + inputs, block, ...]`.

    Biases come first among the inputs; outputs are padded with zeros to whole blocks.
    """
    missing = -len(weights) % block
    padded = torch.cat((weights, weights.new_zeros(missing, *weights.shape[1:])))
    return padded.unflatten(0, (-1, block)).transpose(1, 2).contiguous()


def is_exactly(value: object, kind: type[T]) -> TypeGuard[T]:
    """Return whether `value` is of `kind`, no subclass, with none of its methods replaced.

    A subclass may compute something else, so its parent's kernel must not replace it.
    """
    own = vars(value) if hasattr(value, "__dict__") else {}
    return type(value) is kind and not any(callable(getattr(kind, n, None)) for n in own)


def covered(value: object, kind: type) -> bool:
    """Return whether a kernel of `kind` may replace `value`; warn where it may not."""
    if is_exactly(value, kind):
        return True
    tell_portable(f"The {type(value).__name__}", unlike(kind, value))
    return False


def unlike(kind: type, value: object) -> str:
    """Return in words why a kernel of `kind` may not replace `value`."""
    if type(value) is kind:
        return f"methods of this {kind.__name__} were replaced"
    return f"there is a kernel of {kind.__name__} itself, not of {type(value).__name__}"


def _short(dtype: torch.dtype) -> str:
    return str(dtype).removeprefix("torch.")
