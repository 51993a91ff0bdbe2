"""The simulated vehicles in their scenes, as the plant of the loop."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Batch, Inputs, Outputs, Plant, Port, Progress, Query
from faultpath.system import VEHICLE
from faultpath_quadrotor.batching import lanes_last, scenes_first
from faultpath_quadrotor.device import host_readable
from faultpath_quadrotor.estimators.sensors import Sensor, SensorErrors, raw, readings
from faultpath_quadrotor.perception import DepthRenderer, mounted
from faultpath_quadrotor.perception.module import geometric_clearance
from faultpath_quadrotor.plant.world import CONTROL_STEPS, World
from faultpath_quadrotor.predictors import Physics
from faultpath_quadrotor.scenes.field import DistanceField

LOOK_EVERY = 10
"""Control steps between two looks at whether any trial still runs, where a look waits for the
device: half a second of flight is the most that is computed in vain."""

ACTION = Port("action", "actuators")


@dataclass(frozen=True)
class Flying:
    """A batch in flight. `World` moves itself, so it is the state and what acts on it in one."""

    world: World
    camera: DepthRenderer | None
    clearance: Query | None
    """Clearance of the geometry itself; `None` where nothing reads it."""
    errors: SensorErrors
    """Errors of the raw sensors."""


class VehiclePlant(Plant):
    """Vehicles, wind and geometry, with a camera or with the clearance of the geometry itself.

    Args:
        world: Makes the world of some scenes, by id.
        camera: Makes their camera; `None`: nothing reads depth.
        field: Makes their distance field; `None`: nothing reads the true clearance.
        needed: The raw sensors that an estimator reads, by channel.
        sensor_noise: How large their errors are; see `estimators.sensors`.
    """

    name = "vehicle"
    reads = frozenset({ACTION})
    shows = ("vehicle",)

    def __init__(
        self,
        world: Callable[[Sequence[str]], World],
        camera: Callable[[Sequence[str]], DepthRenderer] | None,
        field: Callable[[Sequence[str]], DistanceField] | None,
        needed: Mapping[str, Sensor] = MappingProxyType({}),
        sensor_noise: float = 0.0,
    ) -> None:
        self.steps = CONTROL_STEPS
        self._world = world
        self._camera = camera
        self._field = field
        self._needed = needed
        self._sensor_noise = sensor_noise
        self.senses = (
            *("mission_goal", "true_physics", "true_wind", "zero_wind"),
            *(("depth_image",) if camera else ()),
            *(("true_clearance",) if field else ()),
            *map(raw, needed),
        )

    def start(self, batch: Batch) -> Flying:
        """Return the batch at the start."""
        return Flying(
            world=self._world(batch.scenes),
            camera=self._camera(batch.scenes) if self._camera else None,
            clearance=geometric_clearance(self._field(batch.scenes)) if self._field else None,
            errors=SensorErrors(
                batch.scenes, batch.seed, self._sensor_noise, self._needed, CONTROL_STEPS
            ),
        )

    def sense(self, state: Flying) -> Outputs:
        """Return the readings of all scenes, without the lanes that only fill the batch up."""
        world, count, vehicle = state.world, state.world.count, state.world.vehicle
        wind = scenes_first(world.wind_mps, count)
        physics = Physics(
            vehicle.inertia_kgm2,
            vehicle.torque_scale,
            vehicle.motor_time_constant_s,
            vehicle.drag_kgps,
            world.plant_state.thrusts.sum(0),
        )
        truth = {
            "mass": vehicle.mass_kg,
            "thrust_scale": vehicle.thrust_scale,
            "position": world.state.position,
            "velocity": world.state.velocity,
            "attitude": world.state.rotation,
            "body_rate": world.state.rate,
        }
        sensed: dict[str, object] = {
            "mission_goal": scenes_first(world.goal, count),
            "true_physics": scenes_first(physics.reading(), count),
            "true_wind": wind,
            "zero_wind": torch.zeros_like(wind),
            "vehicle": {name: scenes_first(value, count) for name, value in truth.items()},
        }
        if state.camera is not None:
            here = replace(world.state, rotation=mounted(world.state.rotation))
            sensed["depth_image"] = state.camera.render(here)
        if state.clearance is not None:
            sensed["true_clearance"] = state.clearance
        exact = readings(world.passed) if self._needed else {}
        for name in self._needed:
            read = scenes_first(exact[name], count)
            sensed[raw(name)] = state.errors.on(name, world.step, read)
        return sensed

    def advance(self, state: Flying, inputs: Inputs) -> Flying:
        """Fly one control interval under the command that reaches the actuators."""
        state.world.advance(lanes_last(inputs[ACTION], state.world.lanes))
        return state

    @override
    def progress(self, state: Flying) -> Progress:
        progress, count = state.world.progress, state.world.count
        return Progress(
            running=progress.running[:count],
            succeeded=progress.succeeded[:count],
            crashed=progress.crashed[:count],
            time_s=progress.time_s[:count],
            metrics={name: getattr(progress, name)[:count] for name in VEHICLE},
        )

    def over(self, state: Flying, step: int) -> bool:
        """See `Plant.over`: only the device knows which trials run there."""
        running = state.world.progress.running
        if not host_readable(running.device) and (step + 1) % LOOK_EVERY:
            return False
        return not bool(running[: state.world.count].any())

    @override
    def conditions(self, state: Flying) -> tuple[Sequence[str], Sequence[str]]:
        return state.world.initial_hashes, state.world.wind_hashes

    @override
    def position(self, state: Flying) -> Tensor:
        return scenes_first(state.world.state.position, state.world.count)
