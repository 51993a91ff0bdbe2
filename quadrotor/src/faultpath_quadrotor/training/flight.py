"""Training episodes: the draws for each, the flight of a batch, and the pools that they make."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from faultpath.plugin.system import UserError, generator
from faultpath_quadrotor import native, so3
from faultpath_quadrotor.plant import TorchPlant
from faultpath_quadrotor.plant.protocol import Vehicle
from faultpath_quadrotor.platform import PLATFORM, FlightSettings
from faultpath_quadrotor.state import State, padded_lanes
from faultpath_quadrotor.training import controller as perturbation
from faultpath_quadrotor.training.controller import Course, WaypointController
from faultpath_quadrotor.training.pool import PoolPart, PoolRecipe, Progress, code_of, make_pool
from faultpath_quadrotor.training.recorded import Flights, blank_values, record
from faultpath_quadrotor.vehicle import (
    CONTROL_RATE_HZ,
    PLANT_RATE_HZ,
    STEPS_PER_CONTROL,
    VehicleParameters,
    draw,
)

EPISODE_S = 6.0  # paper, Section IV-A
EPISODE_STEPS = round(EPISODE_S * CONTROL_RATE_HZ)


@dataclass(frozen=True)
class _Start:
    """Draws for one episode."""

    vehicle: VehicleParameters
    course: Course
    state: State
    winds: np.ndarray | None
    """[T, 3] at the plant's steps, m/s; `None` is still air."""


@torch.inference_mode()
@native.using(native.PORTABLE)
def fly(pool: str, episodes: Sequence[int], seed: int) -> Flights:
    """Fly some episodes of a pool together; the bits of each do not depend on the others.

    The draws of an episode are keyed by pool, episode and seed, and lanes are padded to whole
    vectors. All fly in free air for the same time, diverged or not; nothing passes a tap.
    """
    settings = PLATFORM.collection
    starts = [_draw(pool, episode, seed, settings) for episode in episodes]
    lanes = padded_lanes(len(starts))
    vehicle = Vehicle.stack([start.vehicle for start in starts]).take(lanes)
    course = Course.together([start.course for start in starts]).take(lanes)
    plant, winds = TorchPlant(vehicle), _winds(starts)
    controller = WaypointController(vehicle, course, settings.controller.arrival_m)
    plant_state = plant.start(State.together([start.state for start in starts]).take(lanes))
    running = torch.ones(len(lanes), dtype=torch.bool)
    steps = torch.zeros(len(lanes), dtype=torch.long)
    values = blank_values(EPISODE_STEPS, len(starts))

    def blown(step: int, count: int) -> Tensor:
        first = step * STEPS_PER_CONTROL
        return winds[first : first + count].double()[..., lanes]

    for step in range(EPISODE_STEPS):
        wind_mps = blown(step, 1)[0]
        command = controller.command(step, plant_state.state, wind_mps)
        record(values, step, plant_state, wind_mps, command)
        plant_state = plant.advance(plant_state, command, blown(step, STEPS_PER_CONTROL))
        running &= _in_bounds(plant_state.state, settings)
        steps += running
    record(values, EPISODE_STEPS, plant_state, blown(EPISODE_STEPS, 1)[0])
    vehicles = tuple(start.vehicle for start in starts)
    return Flights(values, steps[: len(starts)].numpy(), vehicles)


def _draw(pool: str, episode: int, seed: int, settings: FlightSettings) -> _Start:
    def stream(purpose: str) -> np.random.Generator:
        return generator(f"collection/{pool}/{purpose}", str(episode), seed)

    disturbed = perturbation.draw(stream("perturbation"), EPISODE_STEPS, settings.perturbation)
    winds = None
    if pool == "wind":  # one sample more than the plant needs: the wind at the last instant
        winds = PLATFORM.winds.pool_series(seed, episode, EPISODE_S + 1 / PLANT_RATE_HZ)
    return _Start(
        vehicle=draw(stream("vehicle"), PLATFORM.ranges),
        course=Course.draw(stream("course"), settings.controller, disturbed),
        state=_draw_state(stream("start"), settings),
        winds=winds,
    )


def _draw_state(stream: np.random.Generator, settings: FlightSettings) -> State:
    """Draw a start in the arena with any heading, some tilt, speed and rates; no batch axes."""
    lows, highs = np.array(settings.controller.arena_m).T
    position = stream.uniform(lows, highs)
    direction = stream.standard_normal(3)
    speed = settings.start_speed_mps * stream.uniform() ** (1 / 3)
    velocity = speed * direction / np.linalg.norm(direction)
    heading, towards = stream.uniform(-np.pi, np.pi, 2)
    tilt = np.radians(settings.start_tilt_deg) * stream.uniform()
    axis = torch.tensor([np.cos(towards), np.sin(towards), 0.0], dtype=torch.float64)
    level = so3.from_yaw(torch.tensor(heading, dtype=torch.float64))
    rate = np.array(settings.start_rate_radps) * stream.uniform(-1, 1, 3)
    return State(
        torch.from_numpy(position),
        torch.from_numpy(velocity),
        so3.compose(so3.exp(tilt * axis), level),
        torch.from_numpy(rate),
    )


def _winds(starts: Sequence[_Start]) -> Tensor:
    """Return the winds of a batch at the plant's steps, [T, 3, B]; still air is a broadcast zero.

    In single precision, so that the wind that is recorded is the wind that blew.
    """
    winds = [torch.from_numpy(start.winds) for start in starts if start.winds is not None]
    if winds:
        return torch.stack(winds, -1).float()
    return torch.zeros(1, 3, 1).expand(EPISODE_STEPS * STEPS_PER_CONTROL + 1, 3, len(starts))


def _in_bounds(state: State, settings: FlightSettings) -> Tensor:
    lows, highs = torch.tensor(settings.volume_m, dtype=torch.float64).T[..., None]
    inside = ((state.position > lows) & (state.position < highs)).all(0)
    slow = (state.velocity * state.velocity).sum(0) < settings.speed_limit_mps**2
    upright = state.rotation[2, 2] > np.cos(np.radians(settings.tilt_limit_deg))
    return inside & slow & upright


EPISODES = {"nominal": 7_150, "wind": 14_891}  # paper, Section IV-A
BATCH = 1024
"""Episodes flown together. The plant's cost a vehicle still falls beyond this; a larger batch would
need more memory for its winds, and a kill would lose more."""


def collect(
    folder: Path,
    pools: Sequence[str] = ("nominal", "wind"),
    workers: int = 2,
    episodes: Mapping[str, int] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> dict[str, Path]:
    """Collect `pools` into `folder` and return the file of each pool.

    A finished pool is kept, an unfinished one is completed. `episodes` gives the number of episodes
    of a pool where it is not the paper's; `workers` is the number of processes, 0 for this one.
    `progress` is called with the episodes done and the total of a pool. Raises `UserError` for a
    pool that does not exist, for one that was collected by another recipe, and when `folder` cannot
    be written.
    """
    recipes = {pool: recipe(pool, (episodes or {}).get(pool), seed) for pool in pools}
    paths: dict[str, Path] = {}
    for pool, pool_recipe in recipes.items():
        every = range(pool_recipe.episodes)
        batches = [every[first : first + BATCH] for first in every[::BATCH]]
        parts = [
            PoolPart(f"{batch.start:06d}+{len(batch)}", len(batch), partial(fly, pool, batch, seed))
            for batch in batches
        ]
        paths[pool] = make_pool(folder, pool_recipe, parts, workers, progress)
    return paths


def recipe(pool: str, episodes: int | None = None, seed: int = 0) -> PoolRecipe:
    """Return what decides a pool's numbers; `UserError` for a pool that cannot be."""
    if pool not in EPISODES:
        raise UserError(f"there is no pool '{pool}': choose from {', '.join(EPISODES)}.")
    count = EPISODES[pool] if episodes is None else episodes
    if count < 1:
        raise UserError(f"pool '{pool}' cannot have {count} episodes: ask for at least one.")
    return PoolRecipe(pool=pool, episodes=count, seed=seed, code_sha256=code_of())
