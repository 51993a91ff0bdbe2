"""Training episodes: what is drawn for each, and how a batch of them flies in the loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import torch
from torch import Tensor
from typing_extensions import override

from faultpath.loop import (
    Batch,
    Inputs,
    Loop,
    Memory,
    Module,
    Outputs,
    Plant,
    Progress,
    consumers,
    graph,
)
from faultpath.quadrotor import native, so3
from faultpath.quadrotor.flight_settings import FlightSettings
from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.quadrotor.plant import Plant as VehiclePlant
from faultpath.quadrotor.plant import TorchPlant
from faultpath.quadrotor.plant.vehicle_batch import Vehicle
from faultpath.quadrotor.platform import PLATFORM
from faultpath.quadrotor.state import State, padded_lanes
from faultpath.quadrotor.training import perturbation
from faultpath.quadrotor.training.controller import Course, WaypointController
from faultpath.quadrotor.training.recorded import ACTION, Flights, record
from faultpath.quadrotor.vehicle import (
    CONTROL_DT_S,
    CONTROL_RATE_HZ,
    PLANT_RATE_HZ,
    STEPS_PER_CONTROL,
    VehicleParameters,
    draw,
)
from faultpath.streams import generator
from faultpath.taps import Taps

EPISODE_S = 6.0  # paper, Section IV-A
EPISODE_STEPS = round(EPISODE_S * CONTROL_RATE_HZ)


@dataclass(frozen=True)
class _Start:
    """What is drawn for one episode."""

    vehicle: VehicleParameters
    course: Course
    state: State
    winds: np.ndarray | None
    """[T, 3] at the plant's steps, m/s; `None` is still air."""


class Airspace:
    """A batch of training flights in free air, padded to whole vectors; it moves itself."""

    def __init__(
        self, plant: VehiclePlant, starts: Sequence[_Start], lanes: Tensor, settings: FlightSettings
    ) -> None:
        self.lanes = lanes
        self.plant_state = plant.start(_stack([start.state for start in starts]).take(lanes))
        self.running = torch.ones(len(lanes), dtype=torch.bool)
        self.steps = torch.zeros(len(lanes), dtype=torch.long)
        """Control steps that ended in bounds."""
        self._plant = plant
        self._winds = _winds(starts)
        self._settings = settings
        self._step = 0

    @property
    def wind_mps(self) -> Tensor:
        """Wind at this moment, `[3, L]`, m/s, world frame."""
        return self._blown(1)[0]

    def advance(self, command: Tensor) -> None:
        """Fly one control interval under `command` `[4, L]` and see which flights diverged."""
        self.plant_state = self._plant.advance(
            self.plant_state, command, self._blown(STEPS_PER_CONTROL)
        )
        self._step += 1
        self.running &= _in_bounds(self.plant_state.state, self._settings)
        self.steps += self.running

    def _blown(self, count: int) -> Tensor:
        first = self._step * STEPS_PER_CONTROL
        return self._winds[first : first + count].double()[..., self.lanes]


class TrainingFlights(Plant):
    """Training flights as the plant of the loop; all last as long, diverged or not."""

    name = "vehicle"
    reads = frozenset({ACTION})
    shows = ("airspace",)

    def __init__(self, airspace: Airspace) -> None:
        self.steps = EPISODE_STEPS
        self._airspace = airspace

    def start(self, batch: Batch) -> Airspace:
        """Return the flights, which have just begun."""
        del batch
        return self._airspace

    def sense(self, state: Airspace) -> Outputs:
        """Return the whole truth: nobody else senses here."""
        return {"airspace": state}

    def advance(self, state: Airspace, inputs: Inputs) -> Airspace:
        """Fly one control interval under the command that reaches the actuators."""
        state.advance(inputs[ACTION].T[:, state.lanes])
        return state

    @override
    def over(self, state: Airspace, step: int) -> bool:
        return False

    def progress(self, state: Airspace) -> Progress:
        """Return which flights are in bounds so far; none arrives anywhere."""
        running = state.running[: int(state.lanes.max()) + 1]
        none = torch.zeros_like(running)
        return Progress(running, none, ~running, state.steps[: len(running)] / CONTROL_RATE_HZ)

    def conditions(self, state: Airspace) -> tuple[Sequence[str], Sequence[str]]:
        """Return nothing: episodes are no pairs."""
        return (), ()


class Collecting(Module):
    """The waypoint controller in the planner's place; it knows the truth past all taps."""

    name, writes = "planner", ("commanded_action",)
    truths = ("airspace",)

    def __init__(self, vehicle: Vehicle, course: Course, arrival_m: float) -> None:
        self._controller = partial(WaypointController, vehicle, course, arrival_m)

    @override
    def begin(self, batch: Batch) -> Memory:
        return self._controller()

    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the perturbed command, `[B, 4]`, N and rad/s."""
        controller: WaypointController = memory
        now: Airspace = inputs.truth("airspace")
        command = controller.command(inputs.step, now.plant_state.state, now.wind_mps)
        return {"commanded_action": command[:, : len(inputs.running)].T}, controller


@torch.inference_mode()
@native.using(native.PORTABLE)
def fly(
    pool: str,
    episodes: Sequence[int],
    seed: int,
    build: Callable[[Vehicle], VehiclePlant] = TorchPlant,
) -> Flights:
    """Fly some episodes of a pool together; each comes out the same in any company, bit for bit.

    The draws of an episode are keyed by pool, episode and seed, and lanes are padded to whole
    vectors.
    """
    settings = PLATFORM.collection
    starts = [_draw(pool, episode, seed) for episode in episodes]
    lanes = padded_lanes(len(starts))
    vehicle = Vehicle.stack([start.vehicle for start in starts]).take(lanes)
    course = Course.stack([start.course for start in starts]).take(lanes)
    airspace = Airspace(build(vehicle), starts, lanes, settings)
    interface = quadrotor_interface()
    modules = [Collecting(vehicle, course, settings.controller.arrival_m)]
    parts = graph(interface, TrainingFlights(airspace), modules)
    batch = Batch(tuple(f"{pool}/{episode}" for episode in episodes), seed, CONTROL_DT_S)
    taps = Taps(interface, scenes=batch.scenes, dt_s=batch.dt_s, consumers=consumers(parts.parts))
    instants = Loop(interface, parts).execute(batch, taps)
    values, _ = record(((now, now.state) for now in instants), len(starts), EPISODE_STEPS)
    steps = airspace.steps[: len(starts)].numpy()
    return Flights(values, steps, tuple(start.vehicle for start in starts))


def _draw(pool: str, episode: int, seed: int) -> _Start:
    settings = PLATFORM.collection

    def stream(what: str) -> np.random.Generator:
        return generator(f"collection/{pool}/{what}", str(episode), seed)

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


def _in_bounds(state: State, settings: FlightSettings) -> Tensor:
    lows, highs = torch.tensor(settings.volume_m, dtype=torch.float64).T[..., None]
    inside = ((state.position > lows) & (state.position < highs)).all(0)
    slow = (state.velocity * state.velocity).sum(0) < settings.speed_limit_mps**2
    upright = state.rotation[2, 2] > np.cos(np.radians(settings.tilt_limit_deg))
    return inside & slow & upright
