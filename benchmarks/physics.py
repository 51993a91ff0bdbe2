"""Our sides of the plant's, the camera's and the statistics' comparisons."""

from collections.abc import Callable, Sequence

import numpy as np
import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.perception import DepthRenderer
from faultpath_quadrotor.perception.camera import mounted
from faultpath_quadrotor.plant import Plant, TorchPlant
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.state import State, padded_lanes
from faultpath_quadrotor.vehicle import STEPS_PER_CONTROL, draw
from torch import Tensor

from benchmarks.side import Side
from faultpath.core.streams import generator
from faultpath.stats.effects import success_effect
from faultpath.stats.resamples import Resamples

VEHICLES = 100
SCENES = 25
RESAMPLES = 10_000


def plant(build: Callable[[Vehicle], Plant] = TorchPlant) -> Side:
    """A control interval of 100 vehicles; the unit is a vehicle's step of 2 ms, float64.

    Rate loop, mixer, motors, drag and wind; lanes are padded as in a flight, padding not counted.
    """
    drawn = [draw(generator("benchmark-vehicle", f"vehicle/{i}", 0)) for i in range(VEHICLES)]
    lanes = padded_lanes(VEHICLES)
    vehicle = Vehicle.stack(drawn).take(lanes)
    flown = build(vehicle)
    still = torch.zeros(3, len(lanes), dtype=torch.float64)
    start = flown.start(State.hover(still, still[0]))
    command = vehicle.hover_command()
    command[1:] += torch.tensor([[1.0], [-0.5], [0.2]])
    shape = (STEPS_PER_CONTROL, 3, len(lanes))
    winds = torch.from_numpy(generator("benchmark-wind", "all", 0).uniform(-5.0, 5.0, shape))
    return Side(lambda: flown.advance(start, command, winds), VEHICLES * STEPS_PER_CONTROL)


def scenes() -> Sequence[Scene]:
    return load_library("selection").scenes[:SCENES]


def camera_poses(chosen: Sequence[Scene]) -> State:
    """Return the poses of a block's cameras at its start, batch `[B]`."""
    position = torch.tensor([scene.start_m for scene in chosen], dtype=torch.float64).T
    yaw = torch.tensor([scene.start_yaw_rad for scene in chosen], dtype=torch.float64)
    state = State.hover(position.contiguous(), yaw)
    return State(state.position, state.velocity, mounted(so3.from_yaw(yaw)), state.rate)


def images() -> Tensor:
    """Return the depth images of the block, `[25, 36, 64]`, m."""
    chosen = scenes()
    return DepthRenderer(chosen).render(camera_poses(chosen))


def rendering() -> Side:
    """The depth images of a block of scenes; the unit is an image of 64 x 36."""
    chosen = scenes()
    renderer, poses = DepthRenderer(chosen), camera_poses(chosen)
    return Side(lambda: renderer.render(poses), len(chosen))


def outcomes() -> tuple[np.ndarray, np.ndarray]:
    """Return successes of two treatments, 100 scenes and 3 seeds."""
    draws = generator("benchmark-outcomes", "all", 0)
    return draws.random((100, 3)) < 0.6, draws.random((100, 3)) < 0.7


def interval() -> tuple[float | None, float | None]:
    """Return the ends of our interval of the effect, percentage points."""
    treatments = outcomes()
    resamples = Resamples.draw("benchmark", len(treatments[0]), n_resamples=RESAMPLES)
    effect = success_effect(*treatments, resamples, test="conditional").estimate()
    return effect.low, effect.high


def bootstrap() -> Side:
    """An effect and its interval, with the draw of its resamples."""
    return Side(interval)
