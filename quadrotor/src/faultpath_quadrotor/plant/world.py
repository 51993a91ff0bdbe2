"""The simulated world of a block of scenes: vehicles, wind, contact and the ends of trials."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.estimators.sensors import SAMPLES
from faultpath_quadrotor.plant import Plant, TorchPlant
from faultpath_quadrotor.plant.protocol import Contact, TrialProgress, Vehicle
from faultpath_quadrotor.plant.wind import Winds
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
    readings that `plant/module.py` makes of `state`, `wind_mps` and `vehicle`.
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
