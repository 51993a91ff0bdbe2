"""One thread a process.

Workers share the processors among themselves, and a sum over several threads may differ in its
last bits.
"""

import sys
from collections.abc import Generator
from contextlib import contextmanager

ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "MKL_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
"""Environment of a process in which numpy and torch, once imported, keep to one thread."""


@contextmanager
def one_thread() -> Generator[None]:
    """Keep torch, where it is loaded, to one thread, and put back what was before."""
    torch = sys.modules.get("torch")
    before = 1 if torch is None else torch.get_num_threads()
    if torch is None or before == 1:
        yield
        return
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
