"""Training episodes: what is drawn for each, and how a batch of them is flown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict
from torch import Tensor

from faultpath.quadrotor import native, so3, wind
from faultpath.quadrotor.plant import Plant, PlantState, TorchPlant
from faultpath.quadrotor.state import State, padded_lanes
from faultpath.quadrotor.training import perturbation
from faultpath.quadrotor.training.controller import (
    ControllerSettings,
    Course,
    Range,
    WaypointController,
)
from faultpath.quadrotor.training.perturbation import PerturbationSettings
from faultpath.quadrotor.vehicle import (
    CONTROL_RATE_HZ,
    PLANT_RATE_HZ,
    STEPS_PER_CONTROL,
    VehicleParameters,
    draw,
)
from faultpath.quadrotor.vehicle_batch import Vehicle
from faultpath.streams import generator

EPISODE_S = 6.0  # paper, Section IV-A
EPISODE_STEPS = round(EPISODE_S * CONTROL_RATE_HZ)

SIGNALS = {
    "position": ("x_m", "y_m", "z_m"),
    "velocity": ("vx_mps", "vy_mps", "vz_mps"),
    "rotation": tuple(f"r{i}{j}" for i in range(3) for j in range(3)),
    "rate": ("roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"),
    "command": ("thrust_n", "roll_command_radps", "pitch_command_radps", "yaw_command_radps"),
    "wind_mps": ("wind_x_mps", "wind_y_mps", "wind_z_mps"),
    "motor_thrust_n": ("motor_thrust_n",),
}
"""What is recorded at each control instant, and the names of its components."""
COMPONENTS = tuple(name for names in SIGNALS.values() for name in names)


class FlightSettings(BaseModel):
    """Everything that decides an episode beside its seed, its pool and the vehicle's ranges."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    controller: ControllerSettings = ControllerSettings()
    perturbation: PerturbationSettings = PerturbationSettings()
    start_speed_mps: float = 3.0
    """The start velocity is uniform in a ball of this radius."""
    start_tilt_deg: float = 30.0
    start_rate_radps: tuple[float, float, float] = (1.5, 1.5, 0.8)
    """Start rates are uniform within plus and minus this."""
    volume_m: tuple[Range, Range, Range] = ((-14.0, 14.0), (-13.0, 13.0), (-10.0, 13.0))
    """An episode ends outside: about 10 m beyond the arena. Free space, without a floor."""
    speed_limit_mps: float = 12.0
    tilt_limit_deg: float = 120.0


@dataclass(frozen=True)
class Flights:
    """What a batch of episodes left behind."""

    values: np.ndarray
    """float32 [C, N + 1, B] at the control instants, in the order of `COMPONENTS`; a command
    stands at the instant from which it acts, and is not a number at the last one."""
    steps: np.ndarray
    """Control steps of each episode before it ended, [B]. Its states are 0..steps; what comes
    after them is not part of it."""
    vehicles: tuple[VehicleParameters, ...]


@dataclass(frozen=True)
class _Start:
    """What is drawn for one episode."""

    vehicle: VehicleParameters
    course: Course
    state: State
    winds: np.ndarray | None
    """[T, 3] at the plant's steps, m/s; `None` is still air."""


@torch.inference_mode()
@native.using(native.PORTABLE)
def fly(
    pool: str,
    episodes: Sequence[int],
    seed: int,
    settings: FlightSettings,
    build: Callable[[Vehicle], Plant] = TorchPlant,
) -> Flights:
    """Fly some episodes of a pool together; each comes out the same in any company, bit for bit.

    The draws of an episode are keyed by pool, episode and seed, and lanes are padded to whole
    vectors.
    """
    starts = [_draw(pool, episode, seed, settings) for episode in episodes]
    lanes = padded_lanes(len(starts))
    vehicle = Vehicle.stack([start.vehicle for start in starts]).take(lanes)
    course = Course.stack([start.course for start in starts]).take(lanes)
    winds = _winds(starts)
    plant = build(vehicle)
    controller = WaypointController(vehicle, course, settings.controller.arrival_m)
    now = plant.start(_stack([start.state for start in starts]).take(lanes))

    values = torch.full((len(COMPONENTS), EPISODE_STEPS + 1, len(starts)), torch.nan)
    running = torch.ones(len(lanes), dtype=torch.bool)
    steps = torch.zeros(len(lanes), dtype=torch.long)
    for step in range(EPISODE_STEPS):
        first = step * STEPS_PER_CONTROL
        block = winds[first : first + STEPS_PER_CONTROL].double()[..., lanes]
        command = controller.command(step, now.state, block[0])
        _record(values[:, step], now, command, block[0])
        now = plant.advance(now, command, block)
        running &= _in_bounds(now.state, settings)
        steps += running
    last = winds[EPISODE_STEPS * STEPS_PER_CONTROL].double()[:, lanes]
    none = torch.full((4, len(lanes)), torch.nan, dtype=torch.float64)
    _record(values[:, EPISODE_STEPS], now, none, last)
    return Flights(
        values.numpy(),
        steps[: len(starts)].numpy(),
        tuple(start.vehicle for start in starts),
    )


def _draw(pool: str, episode: int, seed: int, settings: FlightSettings) -> _Start:
    def stream(what: str) -> np.random.Generator:
        return generator(f"collection/{pool}/{what}", str(episode), seed)

    disturbed = perturbation.draw(stream("perturbation"), EPISODE_STEPS, settings.perturbation)
    winds = None
    if pool == "wind":  # one sample more than the plant needs: the wind at the last instant
        winds = wind.pool_series(seed, episode, EPISODE_S + 1 / PLANT_RATE_HZ)
    return _Start(
        vehicle=draw(stream("vehicle")),
        course=Course.draw(stream("course"), settings.controller, disturbed),
        state=_draw_state(stream("start"), settings),
        winds=winds,
    )


def _draw_state(stream: np.random.Generator, settings: FlightSettings) -> State:
    """A start in the arena with any heading, some tilt, speed and rates; no batch axes."""
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


def _stack(states: Sequence[State]) -> State:
    return State(
        torch.stack([s.position for s in states], -1),
        torch.stack([s.velocity for s in states], -1),
        torch.stack([s.rotation for s in states], -1),
        torch.stack([s.rate for s in states], -1),
    )


def _winds(starts: Sequence[_Start]) -> Tensor:
    """Return the winds of a batch at the plant's steps, [T, 3, B]; still air is a broadcast zero.

    In single precision, so that the wind that is recorded is the wind that blew.
    """
    steps = EPISODE_STEPS * STEPS_PER_CONTROL + 1
    out = torch.zeros(1, 3, len(starts)).expand(steps, -1, -1)
    if any(start.winds is not None for start in starts):
        out = out.clone()
        for lane, start in enumerate(starts):
            if start.winds is not None:
                out[..., lane] = torch.from_numpy(start.winds)
    return out


def _record(into: Tensor, now: PlantState, command: Tensor, wind_mps: Tensor) -> None:
    """Write one control instant of all lanes into `into` [C, B]."""
    state = now.state
    parts = (
        state.position,
        state.velocity,
        state.rotation.flatten(0, 1),
        state.rate,
        command,
        wind_mps,
        now.thrusts.sum(0, keepdim=True),
    )
    into.copy_(torch.cat(parts)[:, : into.shape[1]])


def _in_bounds(state: State, settings: FlightSettings) -> Tensor:
    """Return which flights have not diverged, [L]; one that is not a number has."""
    lows, highs = torch.tensor(settings.volume_m, dtype=torch.float64).T[..., None]
    inside = ((state.position > lows) & (state.position < highs)).all(0)
    slow = (state.velocity * state.velocity).sum(0) < settings.speed_limit_mps**2
    upright = state.rotation[2, 2] > np.cos(np.radians(settings.tilt_limit_deg))
    return inside & slow & upright
