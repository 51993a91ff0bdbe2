"""The simulated world of a block of scenes, and the vehicles in it as the plant of the loop."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import Batch, Inputs, Outputs, Port, Progress, Query
from faultpath.loop import Plant as LoopPlant
from faultpath.system import VEHICLE
from faultpath_quadrotor.batching import lanes_last, scenes_first
from faultpath_quadrotor.device import CPU, host_readable
from faultpath_quadrotor.estimators.sensors import SAMPLES, Sensor, SensorErrors, raw, readings
from faultpath_quadrotor.perception import DepthRenderer, mounted
from faultpath_quadrotor.perception.module import geometric_clearance
from faultpath_quadrotor.plant import Plant, TorchPlant
from faultpath_quadrotor.plant.protocol import Contact, TrialProgress, Vehicle
from faultpath_quadrotor.plant.wind import Winds
from faultpath_quadrotor.predictors import Physics
from faultpath_quadrotor.scenes.field import DistanceField
from faultpath_quadrotor.scenes.geometry import Geometry
from faultpath_quadrotor.scenes.library import GOAL_RADIUS_M
from faultpath_quadrotor.scenes.scene import Scene
from faultpath_quadrotor.state import State, padded_lanes
from faultpath_quadrotor.vehicle import CONTROL_DT_S, CONTROL_RATE_HZ, STEPS_PER_CONTROL

TIME_LIMIT_S = 12.0  # paper, Section IV-B
CONTROL_STEPS = round(TIME_LIMIT_S * CONTROL_RATE_HZ)


class World:
    """Plant, wind and geometry of a block of scenes, padded to whole groups of lanes.

    Evaluation code: it knows the truth and passes through no tap. What modules get of it are the
    readings that `VehiclePlant` makes of `state`, `wind_mps` and `vehicle`.
    """

    def __init__(
        self,
        scenes: Sequence[Scene],
        level: str,
        free_space: bool,
        device: torch.device = CPU,
        plant: Callable[[Vehicle], Plant] = TorchPlant,
        winds: Winds | None = None,
        sampled: bool = False,
    ) -> None:
        order = padded_lanes(len(scenes))
        lanes = [scenes[i] for i in order.tolist()]
        air, duration = winds or Winds(), TIME_LIMIT_S + CONTROL_DT_S
        blown = [air.series(level, scene.index, duration) for scene in scenes]
        series = torch.from_numpy(np.stack(blown, axis=-1))[..., order]
        start = State.hover(
            _points([scene.start_m for scene in lanes]),
            torch.tensor([scene.start_yaw_rad for scene in lanes], dtype=torch.float64),
        )
        self.count = len(scenes)
        self.lanes = order.to(device)
        self.vehicle = Vehicle.stack([scene.vehicle for scene in lanes]).to(device)
        self.goal = _points([scene.goal_m for scene in lanes]).to(device)
        self._winds = series.to(device)
        contact = Contact(Geometry.stack(lanes, free_space, device=device), self.goal)
        self._plant = plant(self.vehicle)
        self.plant_state = self._plant.start(start.to(device))
        self.step = 0
        self._standing = contact.begin(self.state)
        self._part = STEPS_PER_CONTROL // SAMPLES if sampled else STEPS_PER_CONTROL
        self.passed: tuple[State, ...] = (self.state,) * (SAMPLES + 1)
        """Where `sampled`: the states of the last interval at the ends of its parts."""
        self.initial_hashes = tuple(
            _hash(
                torch.cat([part[..., i].reshape(-1) for part in start.parts]),
                scene.content_hash + self._plant.mark,
            )
            for i, scene in enumerate(scenes)
        )
        self.wind_hashes = tuple(_hash(series[..., i]) for i in range(len(scenes)))

    @property
    def state(self) -> State:
        """True state of every lane."""
        return self.plant_state.state

    @property
    def progress(self) -> TrialProgress:
        """Where each lane's trial stands."""
        return self._standing.progress

    @property
    def wind_mps(self) -> Tensor:
        """Wind at this moment, `[3, L]`, m/s, world frame."""
        return self._winds[self.step * STEPS_PER_CONTROL]

    def advance(self, command: Tensor) -> None:
        """Fly one control interval under `command` `[4, L]` and see whose trial ended."""
        steps = self.step * STEPS_PER_CONTROL
        winds = self._winds[steps : steps + STEPS_PER_CONTROL]
        passed, standing = [self.state], self._standing
        for part in winds.split(self._part):
            self.plant_state, standing = self._plant.fly(self.plant_state, command, part, standing)
            passed.append(self.state)
        self.passed = tuple(passed)
        self.step += 1
        # Arrivals are checked once a control step, as the planner acts.
        progress = standing.progress
        arrived = progress.running & (progress.terminal_distance_m <= GOAL_RADIUS_M)
        progress = replace(
            progress, running=progress.running & ~arrived, succeeded=progress.succeeded | arrived
        )
        self._standing = replace(standing, progress=progress)


def _points(points: Sequence[Sequence[float]]) -> Tensor:
    return torch.tensor(points, dtype=torch.float64).T.contiguous()


def _hash(numbers: Tensor, salt: str = "") -> str:
    content = numbers.contiguous().numpy().tobytes() + salt.encode()
    return hashlib.sha256(content).hexdigest()[:16]


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


class VehiclePlant(LoopPlant):
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
