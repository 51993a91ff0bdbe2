"""The simulated world of a block of scenes: vehicles, wind, contact and the ends of trials."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import torch
from torch import Tensor

from faultpath.quadrotor import wind as wind_model
from faultpath.quadrotor.device import CPU
from faultpath.quadrotor.native.plant import CompiledContact, CompiledPlant
from faultpath.quadrotor.plant import Plant, PlantState
from faultpath.quadrotor.scenes.geometry import Geometry
from faultpath.quadrotor.scenes.scene import Scene
from faultpath.quadrotor.state import State, padded_lanes
from faultpath.quadrotor.vehicle import (
    COLLISION_RADIUS_M,
    CONTROL_DT_S,
    CONTROL_RATE_HZ,
    PLANT_RATE_HZ,
    STEPS_PER_CONTROL,
)
from faultpath.quadrotor.vehicle_batch import Vehicle

GOAL_RADIUS_M = 0.5  # paper, Section IV-B
TIME_LIMIT_S = 12.0  # paper, Section IV-B
CONTROL_STEPS = round(TIME_LIMIT_S * CONTROL_RATE_HZ)
CONTACT_EVERY = 5
"""Plant steps between contact checks: 10 ms, 3.4 cm at the planner's top speed."""


@dataclass(frozen=True)
class Progress:
    """Where each lane's trial stands, `[L]`; a lane that is no longer running stays as it ended."""

    running: Tensor
    crashed: Tensor
    succeeded: Tensor
    time_s: Tensor
    terminal_distance_m: Tensor
    min_clearance_m: Tensor

    def to(self, device: torch.device) -> "Progress":
        """Return it on another device."""
        return Progress(*(getattr(self, field.name).to(device) for field in fields(self)))


_WATCHED = ("running", "crashed", "time_s", "terminal_distance_m", "min_clearance_m")
"""What contact checks change, in the order of `CompiledContact.watch`."""


class World:
    """Plant, wind and geometry of a block of scenes, padded to whole groups of lanes.

    Evaluation code: it knows the truth and passes through no tap. What modules get of it are the
    readings that the navigator takes from `state`, `wind_mps` and `vehicle`.
    """

    def __init__(
        self,
        scenes: Sequence[Scene],
        level: str,
        free_space: bool,
        device: torch.device = CPU,
    ) -> None:
        order = padded_lanes(len(scenes))
        lanes = [scenes[i] for i in order.tolist()]
        winds = _wind_series(scenes, level)[..., order]
        start = State.hover(
            _points([scene.start_m for scene in lanes]),
            torch.tensor([scene.start_yaw_rad for scene in lanes], dtype=torch.float64),
        )
        self.initial_hashes = tuple(
            _hash(_row(start, i), scene.content_hash) for i, scene in enumerate(scenes)
        )
        self.wind_hashes = tuple(_hash(winds[..., i].numpy()) for i in range(len(scenes)))

        self.count = len(scenes)
        self.lanes = order.to(device)
        self.vehicle = Vehicle.stack([scene.vehicle for scene in lanes]).to(device)
        self._geometry = Geometry.stack(lanes, free_space, device=device)
        self._winds = winds.to(device)
        self.goal = _points([scene.goal_m for scene in lanes]).to(device)
        self._plant = Plant(self.vehicle)
        self._contact = CompiledContact(self._geometry, self.goal, CONTACT_EVERY, PLANT_RATE_HZ)
        self.plant_state = self._plant.start(start.to(device))
        self.step = 0
        self.progress = self._begin()

    @property
    def state(self) -> State:
        """True state of every lane."""
        return self.plant_state.state

    @property
    def wind_mps(self) -> Tensor:
        """Wind at this moment, `[3, L]`, m/s, world frame."""
        return self._winds[self.step * STEPS_PER_CONTROL]

    def advance(self, command: Tensor) -> None:
        """Fly one control interval under `command` `[4, L]` and see whose trial ended."""
        first = self.step * STEPS_PER_CONTROL
        winds = self._winds[first : first + STEPS_PER_CONTROL]
        if self._plant.compiled is None:
            self.plant_state, progress = self._fly(command, winds)
        else:
            self.plant_state, progress = self._fly_compiled(self._plant.compiled, command, winds)
        self.step += 1
        self.progress = _arrival(progress)

    def _fly(self, command: Tensor, winds: Tensor) -> tuple[PlantState, Progress]:
        state, progress = self.plant_state, self.progress
        made = self.step * STEPS_PER_CONTROL
        for block in winds.split(CONTACT_EVERY):
            made += len(block)
            state = self._plant.advance(state, command, block)
            progress = self._touch(progress, state, made / PLANT_RATE_HZ)
        return state, progress

    def _fly_compiled(
        self, plant: CompiledPlant, command: Tensor, winds: Tensor
    ) -> tuple[PlantState, Progress]:
        """Do what `_fly` does in one call."""
        standing = {name: getattr(self.progress, name).clone() for name in _WATCHED}
        watched = self._contact.watch(self.step * STEPS_PER_CONTROL, tuple(standing.values()))
        now = self.plant_state
        flown = plant.fly(now.state, now.thrusts, command, winds, watched)
        return PlantState(*flown), replace(self.progress, **standing)

    def _begin(self) -> Progress:
        none = torch.zeros_like(self.lanes, dtype=torch.bool)
        zero = torch.zeros_like(self.goal[0])
        return Progress(
            running=~none,
            crashed=none,
            succeeded=none,
            time_s=zero,
            terminal_distance_m=(self.state.position - self.goal).norm(dim=0),
            min_clearance_m=self._clearance(self.state),
        )

    def _clearance(self, state: State) -> Tensor:
        return self._geometry.distance(state.position) - COLLISION_RADIUS_M

    def _touch(self, now: Progress, state: PlantState, time_s: float) -> Progress:
        clearance = self._clearance(state.state)
        hit = now.running & (clearance <= 0)
        distance = (state.state.position - self.goal).norm(dim=0)
        return replace(
            now,
            running=now.running & ~hit,
            crashed=now.crashed | hit,
            time_s=torch.where(now.running, time_s, now.time_s),
            terminal_distance_m=torch.where(now.running, distance, now.terminal_distance_m),
            min_clearance_m=torch.where(
                now.running, torch.minimum(now.min_clearance_m, clearance), now.min_clearance_m
            ),
        )


def _arrival(now: Progress) -> Progress:
    """Arrival is looked for once a control step, at the rate at which the planner acts."""
    there = now.running & (now.terminal_distance_m <= GOAL_RADIUS_M)
    return replace(now, running=now.running & ~there, succeeded=now.succeeded | there)


def _wind_series(scenes: Sequence[Scene], level: str) -> Tensor:
    duration = TIME_LIMIT_S + CONTROL_DT_S
    series = [wind_model.series(level, scene.id, duration, PLANT_RATE_HZ) for scene in scenes]
    return torch.from_numpy(np.stack(series, axis=-1))


def _points(points: Sequence[Sequence[float]]) -> Tensor:
    return torch.tensor(points, dtype=torch.float64).T.contiguous()


def _row(state: State, lane: int) -> np.ndarray:
    parts = (state.position, state.velocity, state.rotation, state.rate)
    return torch.cat([part[..., lane].reshape(-1) for part in parts]).numpy()


def _hash(array: np.ndarray, salt: str = "") -> str:
    content = np.ascontiguousarray(array).tobytes() + salt.encode()
    return hashlib.sha256(content).hexdigest()[:16]
