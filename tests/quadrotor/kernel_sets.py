"""Sets of kernels for tests that compare them."""

from faultpath_quadrotor import native
from faultpath_quadrotor.native import PORTABLE

COMPILED = native.available()
FUSED = tuple(isa for isa in COMPILED if native.load(isa).numerics == "fused")

__all__ = ["COMPILED", "FUSED", "PORTABLE"]
