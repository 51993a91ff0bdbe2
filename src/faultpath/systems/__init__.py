"""Systems from what a user already has: an environment, or a function that makes one step."""

from faultpath.systems.composed import ComposedSystem, Parts
from faultpath.systems.episodes import Episode, Measure
from faultpath.systems.functions import FunctionPlant
from faultpath.systems.modules import row_wise, writes

__all__ = [
    "ComposedSystem",
    "Episode",
    "FunctionPlant",
    "Measure",
    "Parts",
    "row_wise",
    "writes",
]
