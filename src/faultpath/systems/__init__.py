"""Systems from what a user already has: an environment, or a function that makes one step."""

from faultpath.systems.composed import ComposedSystem, Parts
from faultpath.systems.episodes import Episode, Measure
from faultpath.systems.functions import FunctionPlant
from faultpath.systems.modules import row_wise, writes
from faultpath.systems.sharing import Shared, shared_objects
from faultpath.systems.tapped import tapped

__all__ = [
    "ComposedSystem",
    "Episode",
    "FunctionPlant",
    "Measure",
    "Parts",
    "Shared",
    "row_wise",
    "shared_objects",
    "tapped",
    "writes",
]
