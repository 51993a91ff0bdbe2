"""The plant: what the world does with a command, whatever any model believes."""

from faultpath_quadrotor.plant.protocol import Plant, PlantState
from faultpath_quadrotor.plant.torch_plant import TorchPlant
