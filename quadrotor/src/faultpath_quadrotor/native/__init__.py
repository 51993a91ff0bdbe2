"""Compiled kernels of what the planner does most, and the way to the portable path without them.

Every kernel repeats arithmetic that stands in torch elsewhere in the application. The torch form is
the reference: it is what training differentiates and what the tests compare with.
"""

from faultpath_quadrotor.native.library import (
    PORTABLE,
    Kernels,
    available,
    describe,
    kernels,
    kernels_for,
    kernels_on,
    load,
    numerics,
    using,
    whole_vectors,
)
