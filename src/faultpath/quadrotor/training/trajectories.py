"""Closed-loop flights as a pool: what the trajectory-trained reconstruction learns from.

The wind-conditioned predictor, given the true wind, flies selection scenes 0 to 69 among their
obstacles at every windy level (paper, Section IV-B: selection scenes 0-69). Clearance is the
geometry's, so that the pool does not depend on the depth model.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path

from faultpath.execution.provenance import packages
from faultpath.quadrotor import native
from faultpath.quadrotor.choices import PlatformName
from faultpath.quadrotor.platform import PLATFORMS
from faultpath.quadrotor.system import Quadrotor
from faultpath.quadrotor.training.closed_loop import record_flights
from faultpath.quadrotor.training.pool import (
    encode_episodes,
    encode_rows,
    join,
    steps_of,
    vehicle_seconds,
    write_pool,
)
from faultpath.quadrotor.training.provenance import Provenance, code_of
from faultpath.store import atomic
from faultpath.store.lock import locked
from faultpath.trials import SystemSpec
from faultpath.trials.state import system_code
from faultpath.version import __version__
from faultpath.work import local, run_all

POOL = "trajectory"
LIBRARY = "selection"
SCENES = 70
LEVELS = ("L1", "L2", "L3")
VARIANT = "wm-a-wind/true-wind"
SEED = 0
BLOCK = 14

Progress = Callable[[float, float], None]


@dataclass(frozen=True)
class Shard:
    """Flights of one block of scenes, and its place in the pool."""

    level: str
    first: int
    platform: PlatformName = PlatformName.FIRST

    @property
    def name(self) -> str:
        """Name of its files, without their ending; sorted, they are in the pool's order."""
        return f"{self.level}-{self.first:03d}"

    @property
    def episodes(self) -> range:
        """Numbers of its flights in the pool."""
        first = LEVELS.index(self.level) * SCENES + self.first
        return range(first, first + BLOCK)


def shards(platform: PlatformName = PlatformName.FIRST) -> list[Shard]:
    """Return every shard of the pool, in its order."""
    return [Shard(*parts, platform) for parts in product(LEVELS, range(0, SCENES, BLOCK))]


def record(
    folder: Path,
    workers: int = 2,
    platform: PlatformName = PlatformName.FIRST,
    progress: Progress | None = None,
) -> Path:
    """Fly and write the pool, from wherever an earlier call left it; return its file.

    `progress` is called with the flights done and those in all. Raises `UserError` where the
    predictor's checkpoint is missing.
    """
    path = folder / f"{POOL}.parquet"
    place = folder / f".{POOL}-{code_sha256(platform)[:16]}"
    place.mkdir(parents=True, exist_ok=True)
    with locked(folder, lambda text: None):
        atomic.sweep(place)
        todo = [shard for shard in shards(platform) if not (place / f"{shard.name}.rows").exists()]
        done = len(shards()) - len(todo)
        tell = progress or (lambda done, total: None)
        tell(done * BLOCK, len(shards()) * BLOCK)
        with local(workers) as executor:
            for _ in run_all(executor, [partial(fly, shard, place) for shard in todo]):
                done += 1
                tell(done * BLOCK, len(shards()) * BLOCK)
        _assemble(path, place, platform)
    return path


@native.using(native.PORTABLE)
def fly(shard: Shard, place: Path) -> None:
    """Fly a shard and write its two files, the rows last."""
    system = Quadrotor.parse(platform=shard.platform, wind=shard.level, clearance="true")
    scenes = tuple(s.id for s in system.library(LIBRARY).scenes)
    flights = record_flights(system, VARIANT, scenes[shard.first : shard.first + BLOCK], SEED)
    atomic.write(place / f"{shard.name}.episodes", encode_episodes(shard.episodes, flights))
    atomic.write(place / f"{shard.name}.rows", encode_rows(shard.episodes, flights))


def code_sha256(platform: PlatformName = PlatformName.FIRST) -> str:
    """Return a hash of what decides the pool: the system, its weights, and the settings here."""
    spec = SystemSpec(name=Quadrotor.name, options={"platform": platform, "clearance": "true"})
    state = system_code(Quadrotor.parse(**spec.options), spec).state
    code = code_of("training.trajectories")
    settings = (LIBRARY, SCENES, LEVELS, VARIANT, SEED, BLOCK, PLATFORMS[platform].hash)
    content = repr((state.contents, code, *settings))
    return hashlib.sha256(content.encode()).hexdigest()


def _assemble(path: Path, place: Path, platform: PlatformName) -> None:
    rows = join((place / f"{shard.name}.rows").read_bytes() for shard in shards())
    episodes = join((place / f"{shard.name}.episodes").read_bytes() for shard in shards())
    steps = steps_of(episodes)
    provenance = Provenance(
        pool=POOL,
        episodes=len(steps),
        seed=SEED,
        flight=None,
        vehicle=PLATFORMS[platform].ranges,
        closed_loop={
            "library": LIBRARY,
            "scenes": SCENES,
            "levels": list(LEVELS),
            "variant": VARIANT,
        },
        wind={},
        code_sha256=code_sha256(platform),
        faultpath_version=__version__,
        packages=packages(),
        rows=int(steps.sum()) + len(steps),
        vehicle_seconds=vehicle_seconds(steps),
        ended_early=0,
        rows_sha256=hashlib.sha256(rows).hexdigest(),
        episodes_sha256=hashlib.sha256(episodes).hexdigest(),
    )
    write_pool(path, rows, episodes, provenance)
    for shard in shards():
        for ending in ("rows", "episodes"):
            (place / f"{shard.name}.{ending}").unlink()
    place.rmdir()
