"""The information interface of the quadrotor, as `interface.yaml` declares it."""

from functools import cache
from importlib.resources import files

from faultpath.interface import Interface, read_interface


@cache
def quadrotor_interface() -> Interface:
    """Return the interface that training, audits and reports share."""
    return read_interface(files("faultpath.quadrotor").joinpath("interface.yaml").read_text())
