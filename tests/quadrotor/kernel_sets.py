"""Running the application on one set of kernels, for tests that compare sets."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

from faultpath.quadrotor import native
from faultpath.quadrotor.native.library import PORTABLE, VARIABLE

COMPILED = native.available()
FUSED = tuple(isa for isa in COMPILED if native.load(isa).numerics == "fused")


@contextmanager
def running(isa: str) -> Iterator[None]:
    """Let what is built inside choose these kernels."""
    with patch.dict(os.environ, {VARIABLE: isa}):
        native.kernels.cache_clear()
        yield
    native.kernels.cache_clear()


__all__ = ["COMPILED", "FUSED", "PORTABLE", "running"]
