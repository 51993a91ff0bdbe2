"""The plant: what the world does with a command, whatever any model believes."""

from faultpath.quadrotor.plant.plant import Plant, PlantState

__all__ = ["Plant", "PlantState"]
