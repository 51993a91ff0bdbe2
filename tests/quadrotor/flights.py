"""Short flights: what the tests of the system share."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from faultpath_quadrotor.scenes.library import SceneLibrary, as_text
from faultpath_quadrotor.scenes.scene import ArenaBounds, Box, Cylinder, Scene, Topology
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.recorded import FlightData, Flights
from faultpath_quadrotor.vehicle import VehicleParameters

from faultpath.core.arrays import Array
from faultpath.faults import Fault, resolve
from faultpath.loop import DeliveryListener, Query, Reading, Tap, Taps
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import load_system
from faultpath.system import Outcome

STEPS = 12
HELD_OUT = tuple(f"held-out/{i:03d}" for i in range(5))


class Log(DeliveryListener):
    """Keeps each reading and what was delivered of it."""

    def __init__(self) -> None:
        self.kept: dict[tuple[str, str], list[tuple[Array, Array]]] = {}

    def delivered(self, tap: Tap, reading: Reading, step: int, got: Any) -> None:
        if not isinstance(reading.value, Query):
            self._keep(tap, reading.value, got)

    def answered(self, tap, query, step, request, answer, got) -> None:
        self._keep(tap, query.value(answer), query.value(got))

    def _keep(self, tap: Tap, given: Any, got: Any) -> None:
        pair = given.numpy().copy(), got.numpy().copy()
        self.kept.setdefault((tap.channel, tap.reader), []).append(pair)


class LoggingTaps(Taps):
    """Taps that a log observes."""

    def __init__(self, *args, **kwargs) -> None:
        kept = Log()
        super().__init__(*args, observer=kept, **kwargs)
        self.log = kept.kept

    def delivered(self, channel: str, reader: str) -> np.ndarray:
        """Return `[steps, scenes, ...]`."""
        return np.stack([value for _, value in self.log[channel, reader]])


ANALYTIC = {"predictor": "dki-drag", "clearance": "true"}


def quadrotor(**options: str) -> Quadrotor:
    """Return a quadrotor, by default the cheapest: analytic, with ground-truth clearance."""
    system = load_system(SystemSpec(name="quadrotor", options=ANALYTIC | options))
    assert isinstance(system, Quadrotor)
    return system


def fault(text: str, system: Quadrotor | None = None) -> tuple[Fault, ...]:
    return (system or quadrotor()).fault(text)


def wire(
    system: Quadrotor,
    variant: str,
    scenes: Sequence[str],
    faults: Sequence[Fault] = (),
    seed: int = 0,
    without: frozenset[str] = frozenset(),
) -> LoggingTaps:
    """Return the taps as a runner makes them; `without` withholds privileges."""
    parts = system.variants[variant]
    return LoggingTaps(
        system.interface,
        resolve(faults, system.interface, parts.readers),
        scenes=tuple(scenes),
        dt_s=system.control_dt_s,
        seed=seed,
        bindings=parts.bindings,
        readers=parts.readers,
        privileged=parts.privileged - without,
    )


def fly(
    system: Quadrotor,
    variant: str = "dob",
    scenes: Sequence[str] = HELD_OUT[:1],
    faults: Sequence[Fault] = (),
    seed: int = 0,
) -> tuple[list[Outcome], LoggingTaps]:
    taps = wire(system, variant, scenes, faults, seed)
    outcomes = system.run(variant, scenes, taps, seed)
    steps = np.array([round(outcome.time_s / system.control_dt_s + 0.499) for outcome in outcomes])
    taps.verify(steps - 1)
    return outcomes, taps


def bits(outcome: Outcome) -> tuple[object, ...]:
    """Return everything of an outcome, so that equal means equal to the bit."""
    assert outcome.trace is not None
    return (
        outcome.scene,
        outcome.status,
        outcome.time_s,
        outcome.metrics["terminal_distance_m"],
        outcome.metrics["min_clearance_m"],
        outcome.initial_hash,
        outcome.disturbance_hash,
        outcome.planner_noise_hash,
        outcome.trace.shape,
        outcome.trace.tobytes(),
    )


def trace(outcome: Outcome) -> np.ndarray:
    assert outcome.trace is not None
    return outcome.trace


Point = tuple[float, float, float]


def in_memory(flights: Flights) -> FlightData:
    """Return recorded flights as they come back from their files."""
    return FlightData.of("test", flights.tensors())


def spread(scenes: Sequence[Scene], count: int, margin: float = 0.0) -> torch.Tensor:
    """Return points over the arenas of scenes and so far outside, `[3, scenes, count]`."""
    draws = np.random.default_rng(7)
    low = np.array([scene.bounds.low_m for scene in scenes]).T[:, :, None] - margin
    high = np.array([scene.bounds.high_m for scene in scenes]).T[:, :, None] + margin
    return torch.from_numpy(draws.uniform(low, high, (3, len(scenes), count)))


def tumbling(steps: int, lanes: int) -> torch.Tensor:
    """Return commands under which some vehicles crash and some fly on, `[steps, 4, lanes]`."""
    stream = torch.Generator().manual_seed(5)
    commands = torch.randn(steps, 4, lanes, dtype=torch.float64, generator=stream)
    commands[:, 0] = 10 + 4 * commands[:, 0]
    return commands


def hall(
    index: int,
    start: Point = (-3.0, 0.0, 1.0),
    goal: Point = (3.0, 0.0, 1.0),
    things: Sequence[Box | Cylinder] = (),
    size: Point = (10.0, 6.0, 3.0),
    vehicle: VehicleParameters | None = None,
) -> Scene:
    """Return a scene of a hall around the origin, with the nominal vehicle."""
    (x, y, z), boxes = size, tuple(each for each in things if isinstance(each, Box))
    return Scene(
        id=f"halls/{index:03d}",
        index=index,
        library="halls",
        topology=Topology.CLUTTER,
        obstacles=bool(things),
        occluded=False,
        bounds=ArenaBounds(low_m=(-x / 2, -y / 2, 0.0), high_m=(x / 2, y / 2, z)),
        boxes=boxes,
        cylinders=tuple(each for each in things if isinstance(each, Cylinder)),
        start_m=start,
        goal_m=goal,
        start_yaw_rad=0.0,
        vehicle=vehicle or VehicleParameters(),
    )


def with_halls(system: Quadrotor, folder: Path, *scenes: Scene) -> tuple[str, ...]:
    """Write scenes to a library file, make them known to the system, and return their ids."""
    path = folder / "halls.json"
    path.write_text(as_text(SceneLibrary.of("halls", scenes)))
    return tuple(scene.id for scene in system.library(str(path)).scenes)
