"""Sets of kernels for tests that compare them."""

from faultpath_quadrotor import native

FUSED = tuple(isa for isa in native.available() if native.load(isa).numerics == "fused")
