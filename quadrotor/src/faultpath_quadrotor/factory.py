"""Factory of the quadrotor. Torch loads when it is built, not when its options are listed."""

from faultpath.system import System
from faultpath_quadrotor.choices import QuadrotorChoices


def create(choices: QuadrotorChoices) -> System:
    """Build the quadrotor; `UserError` where the device is not there."""
    from faultpath_quadrotor.options import QuadrotorOptions
    from faultpath_quadrotor.system import Quadrotor

    return Quadrotor(QuadrotorOptions.of(choices))
