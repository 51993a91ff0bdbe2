"""Recorded flights, kept in a folder block by block, and the windows cut from them."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faultpath.core.errors import UserError
from faultpath.trials import SystemSpec, load_system
from faultpath.trials.code import system_code
from faultpath_quadrotor.evidence.table import Recording
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.pool import FlightData, join_flights, write_flights
from faultpath_quadrotor.training.provenance import code_of
from faultpath_quadrotor.training.trajectories import record_flights
from faultpath_quadrotor.training.windows import HISTORY, Windows, cut, places

BLOCK = 25
"""Scenes flown together and stored together."""

STRIDE = 5
"""Least spacing of the windows of a flight, control steps. The paper has 1,461 windows of 100
scenes; a quarter of a second between them gives about as many (derived)."""


@dataclass(frozen=True)
class Block:
    """Consecutive scenes of a recording, and the stem of the two files that hold their flights."""

    recording: Recording
    first: int
    scenes: tuple[str, ...]
    stem: str

    def rows(self, folder: Path) -> Path:
        """Return the file that is written last."""
        return folder / f"{self.stem}.rows"

    def fly(self, folder: Path) -> None:
        """Fly the scenes and store the flights."""
        recording = self.recording
        system = quadrotor(recording)
        system.library(recording.library)
        flights = record_flights(system, recording.variant, self.scenes, recording.seed)
        episodes = range(self.first, self.first + len(self.scenes))
        write_flights(folder / self.stem, episodes, flights)


@dataclass(frozen=True)
class Recorded:
    """The windows of a recording, in the order of their scenes, then of their time."""

    windows: Windows
    scenes: tuple[str, ...]
    """Scene of each window, `[W]`."""
    steps: NDArray[np.int64]
    """Control step of each window's present, `[W]`."""


def spec(recording: Recording) -> SystemSpec:
    """Return how the system that a recording is flown with is named."""
    return SystemSpec(name=Quadrotor.name, options=dict(recording.options))


def quadrotor(recording: Recording) -> Quadrotor:
    """Return the system that a recording is flown with; `UserError` for a wrong option."""
    system = load_system(spec(recording))
    assert isinstance(system, Quadrotor)
    return system


def blocks(recording: Recording, count: int | None) -> tuple[Block, ...]:
    """Return the blocks of the first `count` scenes of the recording's library, `None`: of all.

    The stem is a hash of everything that decides the flights. `UserError` for an unknown library,
    variant or option, or for more scenes than there are.
    """
    system = quadrotor(recording)
    library = system.library(recording.library)
    if recording.variant not in system.variants:
        raise UserError(
            f"the quadrotor has no variant {recording.variant!r} to record flights with: choose "
            f"from {', '.join(system.variants)}"
        )
    scenes = tuple(scene.id for scene in library.scenes)
    if count is not None and not 1 <= count <= len(scenes):
        raise UserError(
            f"{count} scenes of library {recording.library!r} cannot be recorded: ask for 1 to "
            f"{len(scenes)}"
        )
    decisive = (
        system_code(system, spec(recording)).state.digest,
        library.content_hash,
        recording.variant,
        recording.seed,
        code_of("training.trajectories", "training.pool"),
    )
    found: list[Block] = []
    for first in range(0, len(scenes[:count]), BLOCK):
        part = scenes[:count][first : first + BLOCK]
        content = repr((*decisive, first, part))
        stem = hashlib.sha256(content.encode()).hexdigest()[:24]
        found.append(Block(recording, first, part, stem))
    return tuple(found)


def recorded(blocks: Sequence[Block], folder: Path) -> Recorded:
    """Read stored blocks of one recording and cut their windows.

    `UserError` when no flight is as long as a window.
    """
    recording = blocks[0].recording
    flown = FlightData.decode(
        recording.name, *join_flights([folder / block.stem for block in blocks])
    )
    place = places(flown, STRIDE)
    if not len(place):
        raise UserError(
            f"no flight of the recording {recording.name} is as long as a window: record more "
            "scenes"
        )
    scenes = [scene for block in blocks for scene in block.scenes]
    return Recorded(
        cut(flown, STRIDE),
        tuple(scenes[episode] for episode in place[:, 0].tolist()),
        place[:, 2] + HISTORY,
    )
