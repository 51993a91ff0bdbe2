"""One arithmetic on every processor with AVX2 and FMA, whatever else it has and whoever made it.

The kernels give the same bits there. The libraries of torch choose their code by the processor
unless they are told before its first operation, so importing this package tells them. It needs no
torch itself, and what a user has set gives way: bits are no matter of taste.
"""

import ctypes
import os
from functools import cache
from pathlib import Path

SETTINGS = {"ATEN_CPU_CAPABILITY": "avx2", "ONEDNN_MAX_CPU_ISA": "AVX2", "MKL_CBWR": "COMPATIBLE"}
"""Torch's own operations and the two libraries of its matrix products. MKL promises the same bits
on processors of all makers in this mode alone."""

NATIVE = Path(__file__).parent / "native"


@cache
def level() -> int:
    """Return what this processor has: 1 AVX2 with FMA, 2 AVX-512 as well, else 0.

    Also 0 where no kernels were built: the portable path keeps the arithmetic of its machine.
    """
    library = NATIVE / "kernels-baseline.so"
    return ctypes.CDLL(str(library)).faultpath_level() if library.exists() else 0


def fix() -> None:
    """Tell torch's libraries, in this process and those that it starts, what to compute with."""
    if level():
        os.environ.update(SETTINGS)
