"""Closed-loop flights as a pool, for the trajectory-trained reconstruction to learn from.

The wind-conditioned predictor, given the true wind, flies selection scenes 0 to 69 among their
obstacles at every windy level (paper, Section IV-B: selection scenes 0-69). Clearance is the
geometry's, so that the pool does not depend on the depth model.
"""

import hashlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch

from faultpath.loop import Batch
from faultpath.plugin.data import system_code
from faultpath.plugin.recording import taps_of
from faultpath.plugin.system import SystemSpec, Treatment, load_system
from faultpath_quadrotor import native
from faultpath_quadrotor.device import CPU
from faultpath_quadrotor.plant.module import ACTION, CONTROL_STEPS, Flying
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training import TRAJECTORY_POOL, recorded
from faultpath_quadrotor.training.pool import PoolPart, PoolRecipe, Progress, code_of, make_pool
from faultpath_quadrotor.training.recorded import Flights, blank_values
from faultpath_quadrotor.vehicle import CONTROL_RATE_HZ


@torch.inference_mode()
def record_flights(system: Quadrotor, variant: str, scenes: Sequence[str], seed: int) -> Flights:
    """Fly a block of scenes under correct inputs and return the records.

    Scene by scene in their order. `seed` is that of the planner's noise and of the variant's
    training. A scene's flight does not depend on the others, bit for bit.
    """
    taps = taps_of(system, Treatment(variant=variant, seed=seed), scenes)
    batch = Batch(tuple(scenes), seed, system.control_dt_s)
    values, world = blank_values(CONTROL_STEPS, len(scenes)), None
    for instant in system.loop(variant, seed).execute(batch, taps):
        flying: Flying = instant.state
        world = flying.world
        command = instant.inputs[ACTION].T[:, world.lanes] if ACTION in instant.inputs else None
        recorded.record(values, instant.step, world.plant_state, world.wind_mps, command)
    assert world is not None
    time_s = world.progress.to(CPU).time_s.numpy()[: len(scenes)]
    # A flight ends with the last instant before its trial did.
    steps = np.floor(time_s * CONTROL_RATE_HZ + 1e-6).astype(np.int64)
    return Flights(values, steps, tuple(system.scene(scene).vehicle for scene in scenes))


LIBRARY = "selection"
SCENES = 70
LEVELS = ("L1", "L2", "L3")
VARIANT = "wm-a-wind/true-wind"
SEED = 0
BLOCK = 14


def record(folder: Path, workers: int = 2, progress: Progress | None = None) -> Path:
    """Fly and write the pool, from wherever an earlier call left it; return its file.

    `progress` is called with the flights done and those in all. Raises `UserError` where the
    predictor's checkpoint is missing.
    """
    batches = [
        PoolPart(f"{level}-{first:03d}", BLOCK, partial(fly, level, first))
        for level in LEVELS
        for first in range(0, SCENES, BLOCK)
    ]
    return make_pool(folder, recipe(), batches, workers, progress)


def recipe() -> PoolRecipe:
    """Return what decides the pool's numbers: the system, its weights, and the settings here."""
    spec = SystemSpec(name=Quadrotor.name, options={"clearance": "true"})
    state = system_code(load_system(spec), spec).state
    settings = (LIBRARY, SCENES, LEVELS, VARIANT, SEED, BLOCK, PLATFORM.hash)
    content = repr((sorted(state.data.items()), state.given, code_of(), *settings))
    code = hashlib.sha256(content.encode()).hexdigest()
    return PoolRecipe(
        pool=TRAJECTORY_POOL, episodes=len(LEVELS) * SCENES, seed=SEED, code_sha256=code
    )


@native.using(native.PORTABLE)
def fly(level: str, first: int) -> Flights:
    """Fly the scenes of a batch, which begins at scene `first`."""
    system = Quadrotor.parse(wind=level, clearance="true")
    scenes = tuple(s.id for s in system.library(LIBRARY).scenes)
    return record_flights(system, VARIANT, scenes[first : first + BLOCK], SEED)
