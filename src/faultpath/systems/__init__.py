"""Systems from what a user already has: an environment, or a function that makes one step."""

from faultpath.systems.composed import ComposedSystem, Parts
from faultpath.systems.episodes import Episode, Measure
from faultpath.systems.functions import FunctionPlant

__all__ = ["ComposedSystem", "Episode", "FunctionPlant", "Measure", "Parts"]
