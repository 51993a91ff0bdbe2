"""The stages of one control step on fixed inputs: the hash of what comes out of each.

`python tests/quadrotor/stages.py` prints them, and with `--keep` writes what `test_bits` expects.
Inputs come from integers by correctly rounded operations alone.
"""

import hashlib
import json
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from itertools import product
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import torch
from faultpath_quadrotor.batching import Delivered
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.estimators import ErrorStateFilter
from faultpath_quadrotor.estimators.sensors import SAMPLES, SENSORS, SensorErrors, readings, sensors
from faultpath_quadrotor.models import clearance_model, estimator, predictor, reconstruction
from faultpath_quadrotor.perception import DepthClearance, DepthRenderer, mounted
from faultpath_quadrotor.planners import CEM, MPPI, NavigationCost, Scored
from faultpath_quadrotor.planners.mppi import softmax
from faultpath_quadrotor.planners.sampler import AutoregressiveSampler, BundledSampler
from faultpath_quadrotor.plant.module import World
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors import Predictor, PredictorInputs
from faultpath_quadrotor.predictors.base import history, predictor_inputs
from faultpath_quadrotor.predictors.rollout import Rollout, rolling
from faultpath_quadrotor.reconstruction import Reconstruction
from faultpath_quadrotor.scenes.field import DistanceField
from faultpath_quadrotor.scenes.library import load_library
from faultpath_quadrotor.state import State
from faultpath_quadrotor.system import Quadrotor
from flights import bits, fly
from torch import Tensor

KEPT = Path(__file__).with_name("stages.json")
SCENES, LANES, CANDIDATES, HORIZON, STEPS = 3, 32, 512, 20, 12

Stages = Iterator[tuple[str, object]]


def numbers(name: str, *shape: int, low: float = -1.0, high: float = 1.0) -> Tensor:
    """Return uniform numbers, float64, that follow from the name."""
    key = int.from_bytes(hashlib.blake2b(name.encode(), digest_size=16).digest(), "little")
    drawn = np.random.Generator(np.random.Philox(key=key)).random(shape)
    return torch.from_numpy(low + (high - low) * drawn)


def rotations(name: str, *batch: int) -> Tensor:
    """Return rotations `[3, 3, *batch]`, float64."""
    w, x, y, z = numbers(name, 4, *batch)
    scale = 2 / (w * w + x * x + y * y + z * z)
    rows = (
        *(1 - scale * (y * y + z * z), scale * (x * y - w * z), scale * (x * z + w * y)),
        *(scale * (x * y + w * z), 1 - scale * (x * x + z * z), scale * (y * z - w * x)),
        *(scale * (x * z - w * y), scale * (y * z + w * x), 1 - scale * (x * x + y * y)),
    )
    return torch.stack(rows).view(3, 3, *batch)


def scenes() -> list[Any]:
    return [PLATFORM.scene(scene) for scene in load_library("selection").scenes[:SCENES]]


def world() -> Stages:
    """Yield what is there before the first step, and then what some of them lead to."""
    flown = World(scenes(), "L3", False, winds=PLATFORM.winds, sampled=True)
    yield "wind", flown._winds
    yield "vehicle", (flown.vehicle, flown.state)
    commands = numbers("command", STEPS, 4, LANES)
    commands[:, 0] = 10 + 4 * commands[:, 0]
    for command in commands:
        flown.advance(command)
    yield "plant", (flown.plant_state, flown.progress)
    exact = readings(flown.passed)
    yield "sensors", exact
    ids = [scene.id for scene in scenes()]
    errors = SensorErrors(ids, 0, 1.0, sensors(), STEPS)
    erring = {name: errors.on(name, 3, exact[name].movedim(-1, 0)[:SCENES]) for name in SENSORS}
    yield "sensors' errors", erring


def state_filter() -> Stages:
    """Yield the error-state filter's beliefs after some readings."""
    eskf = estimator("eskf")
    assert isinstance(eskf, ErrorStateFilter)
    known = None
    for step in range(6):
        read = {
            name: numbers(f"{name} {step}", *sensor.shape, LANES, low=-0.5, high=0.5)
            for name, sensor in sensors().items()
        }
        known = eskf.begun(read) if known is None else eskf.taken(known, read, step)
    yield "filter", (known, eskf.estimates(known, read))


def told(step: int) -> Delivered:
    """Return readings as modules with a memory get them."""
    channels: dict[str, Tensor] = {
        "position": 3 * numbers(f"position {step}", 3, LANES),
        "velocity": 2 * numbers(f"velocity {step}", 3, LANES),
        "attitude": rotations(f"attitude {step}", LANES),
        "body_rate": numbers(f"rate {step}", 3, LANES),
        "action": 5 + 4 * numbers(f"action {step}", 4, LANES),
        "mass": numbers("mass", LANES, low=0.6, high=1.4),
        "thrust_scale": numbers("thrust scale", LANES, low=0.6, high=1.4),
        "accelerometer": 9 * numbers(f"force {step}", SAMPLES, 3, LANES),
    }
    places = ("history", "head", "velocity_difference", "nominal_model", "wind_map", "innovation")
    return {(name, place): value for name, value in channels.items() for place in places}


def winds() -> Stages:
    """Yield what reconstructions say after a few intervals."""
    for name in ("dob", "dob-inertial", "gru", "gru-withheld"):
        model: Reconstruction = reconstruction(name, 0)
        memory = model.begin(told(0))
        for step in range(1, 4):
            memory = model.update(memory, told(step))
        yield f"reconstruction {name}", model.wind(memory)


def rollouts() -> Stages:
    """Yield history codes, inputs, and where commands lead."""
    commands = numbers("candidates", HORIZON, 4, SCENES, CANDIDATES).float()
    commands[:, 0] = 10 + 4 * commands[:, 0]
    past = {
        ("velocity", "history"): 2 * numbers("velocities", 3, 12, LANES),
        ("attitude", "history"): rotations("attitudes", 12, LANES),
        ("body_rate", "history"): numbers("rates", 3, 12, LANES),
        ("action", "history"): 5 + 4 * numbers("actions", 4, 12, LANES),
        **{(name, place): told(0)[name, "head"] for name, place in CALIBRATED},
    }
    for name in ("dki", "dki-drag", "wm-a", "wm-a-wind", "wm-u", "true-parameter"):
        model = predictor(name, 0)
        recorded = history(model.reads, lambda *read: past[read].float())
        code = model.encode(recorded)
        if code is not None:
            yield f"history {name}", code
        inputs = known(model, code)
        yield f"rollout {name}", rolling(model)(inputs, commands)
        if name == "wm-a-wind":
            yield "noisy attitudes", known(model, code, 0.05).state.rotation


CALIBRATED = tuple(product(("mass", "thrust_scale"), ("history", "features")))


def known(model: Predictor, code: Tensor | None, noise: float = 0.0) -> PredictorInputs:
    """Return what a predictor reads at a step."""
    attitude = rotations("attitude now", LANES)
    values = {
        "position": 3 * numbers("position now", 3, LANES),
        "velocity": 2 * numbers("velocity now", 3, LANES),
        "attitude": attitude + noise * numbers("noise", 3, 3, LANES),
        "body_rate": numbers("rate now", 3, LANES),
        "wind": 3 * numbers("wind now", 3, LANES),
        "physics": numbers("physics", 9, LANES, low=0.02, high=0.5),
        "mass": told(0)["mass", "head"],
        "thrust_scale": told(0)["thrust_scale", "head"],
        "history_code": torch.zeros(32, LANES) if code is None else code,
    }
    whole = predictor_inputs(model.reads, lambda channel, place: values[channel].float())
    return whole.take(range(SCENES))


def perception() -> Stages:
    """Yield images, codes, and both clearances."""
    position = numbers("eye", 3, LANES) + torch.tensor([0.0, 0.0, 1.5]).double()[:, None]
    state = State(position, position, mounted(rotations("look", LANES)), position)
    image = DepthRenderer(scenes()).render(state)
    yield "image", image
    points = 4 * numbers("points", 3, SCENES, 320).float()
    yield "true clearance", DistanceField.bake(scenes()).query(points)
    seen = DepthClearance(clearance_model(), settings=PLATFORM.perception)
    seen.capture(image, position[:, :SCENES].T, state.rotation[..., :SCENES].movedim(-1, 0))
    yield "code", seen._captured
    yield "clearance", seen.query(points, range(SCENES))


def planning() -> Stages:
    """Yield noise, candidates, costs and plans."""
    settings = PLATFORM.planner.sampler.model_copy(update={"candidates": CANDIDATES})
    cost = NavigationCost(PLATFORM.planner.weights)
    hover = numbers("hover", SCENES, low=8.0, high=12.0).float()
    planners = {
        "mppi": MPPI(AutoregressiveSampler(settings), cost, PLATFORM.planner.temperature),
        "mppi of bundles": MPPI(BundledSampler(settings), cost, PLATFORM.planner.temperature),
        "cem": CEM(AutoregressiveSampler(settings), cost),
    }
    for name, planner in planners.items():
        search = planner.init(planner.initial_plan(hover), hover)
        noise = planner.noise(["a", "b", "c"], 0, 3)
        yield f"noise {name}", noise
        for iteration in range(2):
            noise = planner.noise(["a", "b", "c"], 0, 3, iteration)
            commands = planner.propose(search, noise)
            scored = scored_of(commands, hover)
            search = planner.update(search, scored)
            yield f"cost {name} {iteration}", (commands, cost(scored))
        yield f"plan {name}", search
    even = 0.1 * numbers("even costs", SCENES, CANDIDATES).float()
    yield "weights", softmax(even, 1.0)


def scored_of(commands: Tensor, hover: Tensor) -> Scored:
    positions = 3 * numbers("positions", 3, SCENES, HORIZON, CANDIDATES).float()
    velocities = 3 * numbers("ways", 3, SCENES, HORIZON, CANDIDATES).float()
    final = State(
        *(positions[:, :, -1], velocities[:, :, -1]),
        rotations("ends", SCENES, CANDIDATES).float(),
        velocities[:, :, 0],
    )
    clearance = numbers("free", SCENES, HORIZON, CANDIDATES).float()
    goal = 5 * numbers("goal", 3, SCENES).float()
    return Scored(Rollout(positions, velocities, final), commands, clearance, goal, hover)


FLIGHTS: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "the main job": ("gru+dcc", {"wind": "L3"}),
    "true parameters": ("dob", {"predictor": "true-parameter", "environment": "free-space"}),
    "without physics": ("wm-u", {"wind": "L2"}),
    "a filter": ("gru", {"wind": "L3", "estimator": "eskf"}),
    "cross-entropy": ("gru", {"wind": "L3", "planner": "cem"}),
}
"""Variant and options of each."""


def flights() -> Stages:
    """Yield the first steps of whole trials."""
    scenes = ["selection/000", "selection/001"]
    with patch("faultpath_quadrotor.plant.module.CONTROL_STEPS", STEPS):
        for name, (variant, options) in FLIGHTS.items():
            outcomes, _ = fly(Quadrotor.parse(**options), variant, scenes)
            yield f"flight: {name}", [bits(outcome)[3:] for outcome in outcomes]


PARTS: tuple[Callable[[], Stages], ...] = (
    *(world, state_filter, winds, rollouts, perception, planning, flights),
)


@arithmetic()
@torch.inference_mode()
def measured() -> dict[str, str]:
    """Return the hash of what each stage gives in this process."""
    return {name: digest(value) for part in PARTS for name, value in part()}


def digest(value: object) -> str:
    """Return a hash of all numbers in a value, in a fixed order."""
    return hashlib.sha256(b"".join(_contents(value))).hexdigest()[:16]


def _contents(value: Any) -> Iterator[bytes]:
    if isinstance(value, Tensor):
        yield f"{value.dtype}{list(value.shape)}".encode() + value.numpy().tobytes()
    elif isinstance(value, Mapping):
        yield from _contents([value[name] for name in sorted(value)])
    elif is_dataclass(value):
        yield from _contents([getattr(value, field.name) for field in fields(value)])
    elif isinstance(value, tuple | list):
        yield from (content for part in value for content in _contents(part))
    else:
        yield value if isinstance(value, bytes) else repr(value).encode()


if __name__ == "__main__":
    text = json.dumps(measured(), indent=1) + "\n"
    if "--keep" in sys.argv:
        KEPT.write_text(text)
    else:
        print(text, end="")
