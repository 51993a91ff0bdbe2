"""The information interface of the quadrotor, as `interface.yaml` declares it."""

from functools import cache
from importlib.resources import files

from faultpath.interface import Interface, read_interface

LIMITS, GEOFENCE = "altitude_limits", "geofence"


@cache
def quadrotor_interface(limited: bool = False) -> Interface:
    """Return the interface that training, audits and reports share.

    `limited` says whether perception knows the altitudes between which to fly.
    """
    declared = read_interface(files("faultpath.quadrotor").joinpath("interface.yaml").read_text())
    if limited:
        return declared
    channels = tuple(each for each in declared.channels if each.name != LIMITS)
    sources = tuple(each for each in declared.sources if each.name != GEOFENCE)
    return declared.model_copy(update={"channels": channels, "sources": sources})
