"""Recorded flights, kept in a folder block by block, and the windows cut from them."""

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.pool import code_of, joined, pool_path, store
from faultpath_quadrotor.training.recorded import FlightData
from faultpath_quadrotor.training.trajectories import record_flights
from faultpath_quadrotor.training.windows import HISTORY, Windows, cut, places
from numpy.typing import NDArray

from faultpath.run.code import system_code
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import load_system
from faultpath_paper.evidence.table import Recording

BLOCK = 25
"""Scenes flown together and stored together."""

STRIDE = 5
"""Least spacing of the windows of a flight, control steps. The paper has 1,461 windows of 100
scenes; a quarter of a second between them gives about as many (derived)."""


@dataclass(frozen=True)
class Block:
    """Consecutive scenes of a recording, and the stem of the file that holds their flights."""

    recording: Recording
    scenes: tuple[str, ...]
    stem: str

    def rows(self, folder: Path) -> Path:
        """Return the path of the file."""
        return pool_path(folder, self.stem)

    @arithmetic()
    def fly(self, folder: Path) -> None:
        """Fly the scenes and store the flights."""
        recording = self.recording
        system = quadrotor(recording)
        system.library(recording.library)
        flights = record_flights(system, recording.variant, self.scenes, recording.seed)
        store(self.rows(folder), flights)


@dataclass(frozen=True)
class RecordedWindows:
    """The windows of a recording, in the order of their scenes, then of their time."""

    windows: Windows
    scenes: tuple[str, ...]
    """Scene of each window, `[W]`."""
    steps: NDArray[np.int64]
    """Control step of each window's present, `[W]`."""


def _spec(recording: Recording) -> SystemSpec:
    return SystemSpec(name=Quadrotor.name, options=dict(recording.options))


def quadrotor(recording: Recording) -> Quadrotor:
    """Return the system that a recording is flown with."""
    system = load_system(_spec(recording))
    assert isinstance(system, Quadrotor)
    return system


def blocks(recording: Recording, count: int | None) -> tuple[Block, ...]:
    """Return the blocks of the first `count` scenes of the recording's library, `None`: of all.

    The stem is a hash of everything that decides the flights.
    """
    system = quadrotor(recording)
    library = system.library(recording.library)
    scenes = tuple(scene.id for scene in library.scenes[:count])
    decisive = (
        system_code(system, _spec(recording)).state.digest,
        library.content_hash,
        recording.variant,
        recording.seed,
        code_of(),
    )
    library_blocks: list[Block] = []
    for first in range(0, len(scenes), BLOCK):
        part = scenes[first : first + BLOCK]
        content = repr((*decisive, first, part))
        stem = hashlib.sha256(content.encode()).hexdigest()[:24]
        library_blocks.append(Block(recording, part, stem))
    return tuple(library_blocks)


@lru_cache(maxsize=1)
def recorded(blocks: tuple[Block, ...], folder: Path) -> RecordedWindows:
    """Read stored blocks of one recording and cut their windows."""
    tensors = joined(block.rows(folder) for block in blocks)
    flown = FlightData.of(blocks[0].recording.name, tensors)
    place = places(flown, STRIDE)
    scenes = [scene for block in blocks for scene in block.scenes]
    return RecordedWindows(
        cut(flown, STRIDE),
        tuple(scenes[episode] for episode in place[:, 0].tolist()),
        place[:, 2] + HISTORY,
    )
