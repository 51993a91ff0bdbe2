"""Closed-loop flights as a pool: what the trajectory-trained reconstruction learns from.

The wind-conditioned predictor, given the true wind, flies selection scenes 0 to 69 among their
obstacles at every windy level (paper, Section IV-B: selection scenes 0-69). Clearance is the
geometry's, so that the pool does not depend on the depth model.
"""

import hashlib
from functools import partial
from pathlib import Path

from faultpath.trials import SystemSpec
from faultpath.trials.state import system_code
from faultpath_quadrotor import native
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.closed_loop import record_flights
from faultpath_quadrotor.training.collection import Batch, make_pool
from faultpath_quadrotor.training.parts import Progress
from faultpath_quadrotor.training.provenance import Recipe, code_of
from faultpath_quadrotor.training.recorded import Flights

POOL = "trajectory"
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
        Batch(
            f"{level}-{first:03d}",
            range(count * SCENES + first, count * SCENES + first + BLOCK),
            partial(fly, level, first),
        )
        for count, level in enumerate(LEVELS)
        for first in range(0, SCENES, BLOCK)
    ]
    return make_pool(folder, recipe(), batches, workers, progress)


def recipe() -> Recipe:
    """Return what decides the pool's numbers."""
    return Recipe(pool=POOL, episodes=len(LEVELS) * SCENES, seed=SEED, code_sha256=code_sha256())


@native.using(native.PORTABLE)
def fly(level: str, first: int) -> Flights:
    """Fly the scenes of a batch, which begins at scene `first`."""
    system = Quadrotor.parse(wind=level, clearance="true")
    scenes = tuple(s.id for s in system.library(LIBRARY).scenes)
    return record_flights(system, VARIANT, scenes[first : first + BLOCK], SEED)


def code_sha256() -> str:
    """Return a hash of what decides the pool: the system, its weights, and the settings here."""
    spec = SystemSpec(name=Quadrotor.name, options={"clearance": "true"})
    state = system_code(Quadrotor.parse(**spec.options), spec).state
    code = code_of("training.trajectories")
    settings = (LIBRARY, SCENES, LEVELS, VARIANT, SEED, BLOCK, PLATFORM.hash)
    content = repr((state.contents, code, *settings))
    return hashlib.sha256(content.encode()).hexdigest()
