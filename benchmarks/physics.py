"""Our sides of the plant's and the camera's comparisons."""

from collections.abc import Callable, Sequence

import torch
from torch import Tensor
from typing_extensions import override

from benchmarks.side import Side
from faultpath.quadrotor import so3
from faultpath.quadrotor.perception import DepthRenderer
from faultpath.quadrotor.perception.camera import mounted
from faultpath.quadrotor.plant import Plant, PlantState, TorchPlant
from faultpath.quadrotor.scenes.library import load_library
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.state import State, padded_lanes
from faultpath.quadrotor.vehicle import STEPS_PER_CONTROL, VehicleParameters, draw
from faultpath.quadrotor.vehicle_batch import Vehicle
from faultpath.streams import generator

VEHICLES = 100
SCENES = 25


def vehicles(count: int) -> list[VehicleParameters]:
    """Return vehicles drawn from the ranges of the collected flights."""
    return [draw(generator("benchmark-vehicle", f"vehicle/{i}", 0)) for i in range(count)]


class FullPlant(Side):
    """A control interval of every vehicle; the unit is a vehicle's step of 2 ms, float64.

    Rate loop, mixer, motors, drag and wind; lanes are padded as in a flight, padding not counted.
    """

    def __init__(
        self, count: int = VEHICLES, build: Callable[[Vehicle], Plant] = TorchPlant
    ) -> None:
        torch.set_num_threads(1)
        self.amount = count * STEPS_PER_CONTROL
        lanes = padded_lanes(count)
        vehicle = Vehicle.stack(vehicles(count)).take(lanes)
        self._plant = build(vehicle)
        still = torch.zeros(3, len(lanes), dtype=torch.float64)
        self._state = self._plant.start(State.hover(still, still[0]))
        self._command = vehicle.hover_command()
        self._command[1:] += torch.tensor([[1.0], [-0.5], [0.2]])
        draws = generator("benchmark-wind", "all", 0)
        shape = (STEPS_PER_CONTROL, 3, len(lanes))
        self._winds = torch.from_numpy(draws.uniform(-5.0, 5.0, shape))

    @torch.inference_mode()
    @override
    def work(self) -> None:
        self._fly()

    @torch.inference_mode()
    def answer(self) -> Sequence[float]:
        """Return where the vehicles are after the interval, m."""
        return self._fly().state.position.flatten().tolist()

    def _fly(self) -> PlantState:
        return self._plant.advance(self._state, self._command, self._winds)


def scenes() -> Sequence[Scene]:
    """Return a block of the selection library."""
    return load_library("selection").scenes[:SCENES]


def camera_poses(chosen: Sequence[Scene]) -> State:
    """Return where the cameras of a block are at its start, batch `[B]`."""
    position = torch.tensor([scene.start_m for scene in chosen], dtype=torch.float64).T
    yaw = torch.tensor([scene.start_yaw_rad for scene in chosen], dtype=torch.float64)
    state = State.hover(position.contiguous(), yaw)
    return State(state.position, state.velocity, mounted(so3.from_yaw(yaw)), state.rate)


class Rendering(Side):
    """The depth images of a block of scenes; the unit is an image of 64 x 36."""

    def __init__(self) -> None:
        torch.set_num_threads(1)
        chosen = scenes()
        self.amount = len(chosen)
        self._renderer = DepthRenderer(chosen)
        self._poses = camera_poses(chosen)

    @torch.inference_mode()
    @override
    def work(self) -> None:
        self._renderer.render(self._poses)

    @override
    def answer(self) -> Sequence[float]:
        return depths(self._renderer.render(self._poses))


def depths(images: Tensor) -> list[float]:
    """Return the mean depth of each image, m: a pixel on an edge may fall on either side."""
    return images.flatten(1).double().mean(1).tolist()
