"""Finding and loading the compiled kernels that this processor runs fastest."""

import ctypes
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import torch
from torch import Tensor

from faultpath.plugin.system import UserError
from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.instructions import NATIVE, SETTINGS, level
from faultpath_quadrotor.native.kernel_args import Block, Lent

VARIABLE = "FAULTPATH_KERNELS"
PORTABLE = "portable"
AUTO = "auto"
SETS = ("avx512", "avx2", "baseline")
"""Instruction sets by falling speed."""

_FUSING = {"avx512", "avx2"}

WIDEST = 16
"""Numbers in the widest vector."""


@dataclass(frozen=True)
class Kernels:
    """The compiled kernels of one instruction set."""

    isa: str
    library: ctypes.CDLL

    def call(self, name: str, *arguments: object) -> None:
        """Call a kernel: with what was lent to it, integers and blocks.

        Raises `TypeError` for a tensor that was not lent: nobody has checked it.
        """
        getattr(self.library, name)(*(_argument(value) for value in arguments))

    @property
    def numerics(self) -> str:
        """Name of its rounding; sets that fuse multiply and add agree to the bit."""
        return "fused" if self.isa in _FUSING else self.isa


def _argument(value: object) -> object:
    if isinstance(value, Lent):
        return value.address
    if isinstance(value, Block):
        return ctypes.byref(value)
    if isinstance(value, Tensor):
        raise TypeError("a kernel takes no tensor that was not lent: see `native/kernel_args.py`")
    return ctypes.c_int64(value) if isinstance(value, int) else value


_choice: ContextVar[str] = ContextVar("kernels", default="")


@contextmanager
def using(choice: str) -> Iterator[None]:
    """Use an instruction set, or `portable`, for everything built and called inside.

    Training data are made on the portable path: a pool has the same bytes with kernels and without.
    """
    before = _choice.set(choice)
    try:
        yield
    finally:
        _choice.reset(before)


def kernels() -> Kernels | None:
    """Return the kernels to run, or `None` for the portable path.

    `FAULTPATH_KERNELS` names an instruction set, `portable` or `auto`; unset, it is `auto`.

    Raises:
        UserError: It names something else, a set that was not built or does not run here, or the
            kernels are older than their sources.
    """
    return _chosen(_choice.get() or os.environ.get(VARIABLE) or AUTO)


@cache
def _chosen(choice: str) -> Kernels | None:
    if choice == PORTABLE:
        return None
    if choice not in (AUTO, *SETS):
        names = ", ".join((AUTO, *SETS, PORTABLE))
        raise UserError(f"{VARIABLE} is '{choice}': it takes one of {names}.")
    for isa in available() if choice == AUTO else (choice,):
        return load(isa)
    return None


def kernels_on(device: torch.device) -> Kernels | None:
    """Return the kernels for tensors on `device`: off the CPU the portable path runs."""
    return kernels() if host_readable(device) else None


def kernels_for(*tensors: Tensor) -> Kernels | None:
    """Return the kernels for these tensors.

    The portable path runs for any that is in another precision or off the CPU, and where a gradient
    should flow through one.
    """
    learning = torch.is_grad_enabled()
    for tensor in tensors:
        if tensor.dtype != torch.float32 or (learning and tensor.requires_grad):
            return None
        if not host_readable(tensor.device):
            return None
    return kernels()


def whole_vectors(count: int) -> bool:
    """Return whether so many candidates fill whole vectors: some kernels take no others."""
    return count > 0 and count % WIDEST == 0


def numerics() -> str:
    """Return the name of the arithmetic here: with the same one trials have the same bits.

    It holds for every processor, and results of two are never mixed in a folder.
    """
    built = kernels()
    if built is None:
        return PORTABLE
    version = hashlib.sha256(f"{_sources()} {SETTINGS}".encode()).hexdigest()[:8]
    return f"{built.numerics} {version}"


def describe() -> str:
    """Return in words what runs here, and why it is not the fast path."""
    built = kernels()
    if built is not None:
        return f"compiled kernels (arithmetic {numerics()})"
    if available():
        return f"the portable path, as {VARIABLE} asks, which has last digits of its own"
    return (
        "the portable path, several times slower than compiled kernels and with last digits of its "
        "own: there was no C++ compiler at installation"
    )


def available() -> tuple[str, ...]:
    """Return the instruction sets that were built and that this processor has, fastest first."""
    return tuple(isa for isa in SETS[-1 - level() :] if _path(isa).exists())


def load(isa: str) -> Kernels:
    """Load the kernels of one instruction set; `UserError` where that cannot be."""
    if isa not in available():
        raise UserError(
            f"kernels '{isa}' were not built or do not run on this processor: "
            f"set {VARIABLE} to one of {', '.join((*available(), PORTABLE))}."
        )
    library = ctypes.CDLL(str(_path(isa)))
    library.faultpath_sources.restype = ctypes.c_char_p
    if library.faultpath_sources().decode() != _sources():
        raise UserError(
            f"kernels '{isa}' were built from other sources than those beside them: "
            "install faultpath again (in a checkout: make setup)."
        )
    return Kernels(isa, library)


@cache
def _sources() -> str:
    files = sorted((NATIVE / "source").iterdir())
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def _path(isa: str) -> Path:
    return NATIVE / f"kernels-{isa}.so"
