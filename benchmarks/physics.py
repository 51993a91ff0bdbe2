"""Our sides of the plant's and the camera's comparisons."""

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from benchmarks.measure import Side
from faultpath.quadrotor import so3
from faultpath.quadrotor.perception import DepthRenderer
from faultpath.quadrotor.perception.camera import mounted
from faultpath.quadrotor.plant import Plant, PlantState, TorchPlant
from faultpath.quadrotor.plant.vehicle_batch import Vehicle
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.state import State, padded_lanes
from faultpath.quadrotor.vehicle import STEPS_PER_CONTROL, VehicleParameters, draw
from faultpath.streams import generator

VEHICLES = 100
SCENES = 25


def vehicles() -> list[VehicleParameters]:
    """Return vehicles drawn from the ranges of the collected flights."""
    return [draw(generator("benchmark-vehicle", f"vehicle/{i}", 0)) for i in range(VEHICLES)]


def full_plant(build: Callable[[Vehicle], Plant] = TorchPlant) -> Side:
    """A control interval of every vehicle; the unit is a vehicle's step of 2 ms, float64.

    Rate loop, mixer, motors, drag and wind; lanes are padded as in a flight, padding not counted.
    """
    lanes = padded_lanes(VEHICLES)
    vehicle = Vehicle.stack(vehicles()).take(lanes)
    plant = build(vehicle)
    still = torch.zeros(3, len(lanes), dtype=torch.float64)
    start = plant.start(State.hover(still, still[0]))
    command = vehicle.hover_command()
    command[1:] += torch.tensor([[1.0], [-0.5], [0.2]])
    shape = (STEPS_PER_CONTROL, 3, len(lanes))
    winds = torch.from_numpy(generator("benchmark-wind", "all", 0).uniform(-5.0, 5.0, shape))

    def flown() -> PlantState:
        return plant.advance(start, command, winds)

    def ends() -> Sequence[float]:
        """Return where the vehicles are after the interval, m."""
        return flown().state.position.flatten().tolist()

    return Side(flown, VEHICLES * STEPS_PER_CONTROL, ends)


def scenes() -> Sequence[Scene]:
    """Return a block of the selection library."""
    return load_library("selection").scenes[:SCENES]


def camera_poses(chosen: Sequence[Scene]) -> State:
    """Return where the cameras of a block are at its start, batch `[B]`."""
    position = torch.tensor([scene.start_m for scene in chosen], dtype=torch.float64).T
    yaw = torch.tensor([scene.start_yaw_rad for scene in chosen], dtype=torch.float64)
    state = State.hover(position.contiguous(), yaw)
    return State(state.position, state.velocity, mounted(so3.from_yaw(yaw)), state.rate)


def rendering() -> Side:
    """The depth images of a block of scenes; the unit is an image of 64 x 36."""
    chosen = scenes()
    renderer, poses = DepthRenderer(chosen), camera_poses(chosen)

    def drawn() -> Tensor:
        return renderer.render(poses)

    return Side(drawn, len(chosen), lambda: depths(drawn()))


def depths(images: Tensor) -> list[float]:
    """Return the mean depth of each image, m: a pixel on an edge may fall on either side."""
    return images.flatten(1).double().mean(1).tolist()
