"""Recorded flights, kept in a folder block by block, and quantities measured on their windows."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
import torch
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.predictors.kinematic import LinearDrag
from faultpath_quadrotor.reconstruction import DisturbanceObserver
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.pool import (
    DataFile,
    Progress,
    code_of,
    joined,
    make_missing,
    pool_path,
    store,
)
from faultpath_quadrotor.training.recorded import FlightData
from faultpath_quadrotor.training.trajectories import record_flights
from faultpath_quadrotor.training.windows import HISTORY, Windows, cut, places
from numpy.typing import NDArray
from torch import Tensor

from faultpath.core.files import atomic
from faultpath.core.files.atomic import locked, make_folder
from faultpath.run.code import system_code
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import load_system
from faultpath_paper.evidence.inputs import Subject, with_shuffled_history
from faultpath_paper.evidence.playback import Present
from faultpath_paper.evidence.table import (
    EvidenceTable,
    Measured,
    Measurement,
    Quantity,
    Recording,
    read_evidence,
    write_evidence,
)

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
        flown = partial(record_flights, system, recording.variant, self.scenes, recording.seed)
        store(self.rows(folder), flown)


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


At = Callable[..., Present]
"""What a variant gets and predicts at the present, of given windows and faults if not its own."""


@torch.inference_mode()
def measured(measurement: Measurement, recorded: RecordedWindows) -> Measured:
    """Measure on every window.

    A window's number does not depend on the windows beside it, to the bit, unless a fault on the
    history code exchanges them.
    """
    recording, own = measurement.recording, recorded.windows
    subject = Subject.load(quadrotor(recording), measurement.subject, measurement.seed)

    def present(windows: Windows = own, faults: Sequence[str] = measurement.faults) -> Present:
        return subject.at_present(windows, faults, recording.name)

    values = _QUANTITIES[measurement.quantity](present, own, measurement.seed)
    return Measured(recorded.scenes, recorded.steps, values.double().numpy())


def _position_error(present: At, windows: Windows, seed: int) -> Tensor:
    return (present().positions()[..., -1] - windows.position[:, -1]).norm(dim=0)


def _position_response(present: At, windows: Windows, seed: int) -> Tensor:
    here, there = present(faults=()).positions()[..., -1], present().positions()[..., -1]
    return (there - here).norm(dim=0)


def _shuffle_response(present: At, windows: Windows, seed: int) -> Tensor:
    shuffled = with_shuffled_history(windows, seed)
    here, there = present().positions()[..., -1], present(shuffled).positions()[..., -1]
    return (there - here).norm(dim=0)


def _acceleration_error(present: At, windows: Windows, seed: int) -> Tensor:
    moment = present()
    mass, scale = (moment[channel, "predictor.dynamics"] for channel in windows.calibration)
    believed = replace(windows, mass_kg=mass, thrust_scale=scale)
    nominal = _nominal(believed) - _nominal(windows)
    return (nominal + _wind_term_difference(moment, windows)).norm(dim=0)


def _wind_term_error(present: At, windows: Windows, seed: int) -> Tensor:
    return _wind_term_difference(present(), windows).norm(dim=0)


_QUANTITIES: Mapping[Quantity, Callable[[At, Windows, int], Tensor]] = {
    "position-error": _position_error,
    "position-response": _position_response,
    "shuffle-response": _shuffle_response,
    "acceleration-error": _acceleration_error,
    "wind-term-error": _wind_term_error,
}


def _nominal(windows: Windows) -> Tensor:
    """Return a_0 at the present, as the observer explains it, `[3, W]`, m/s^2.

    Paper, Section "Calibration-Dependent Compensation": what the observer takes out of an
    acceleration is put back here.
    """
    delivered = {
        ("velocity", "velocity_difference"): windows.velocity[:, HISTORY],
        ("attitude", "nominal_model"): windows.rotation[:, :, HISTORY],
        ("action", "nominal_model"): windows.command[:, HISTORY - 1],
        ("mass", "nominal_model"): windows.mass_kg,
        ("thrust_scale", "nominal_model"): windows.thrust_scale,
    }
    return DisturbanceObserver(PLATFORM.drag_kgps).nominal(delivered)


def _wind_term_difference(present: Present, windows: Windows) -> Tensor:
    def term(map_mass_kg: Tensor, wind_mps: Tensor) -> Tensor:
        force = LinearDrag(PLATFORM.drag_kgps).force(windows.rotation[:, :, HISTORY], wind_mps)
        return force / map_mass_kg

    believed = term(present["mass", "predictor.wind_map"], present.wind())
    return believed - term(windows.mass_kg, windows.wind_mps[:, HISTORY])


Blocks = tuple[Block, ...]


def measure(
    measurements: Sequence[Measurement],
    scenes: int | None,
    folder: Path,
    workers: int = 0,
    progress: Progress | None = None,
) -> EvidenceTable:
    """Record and measure what the folder lacks, and return all of `measurements`.

    `scenes` is how many of each library's count, `None` for all; `workers` is how many processes
    there are, 0 for this one alone. The next call goes on from the folder.
    """
    unique = tuple(dict.fromkeys(measurements))
    recordings = dict.fromkeys(measurement.recording for measurement in unique)
    flown = {recording: blocks(recording, scenes) for recording in recordings}
    # One recording after the other: `recorded` keeps the windows of the last one.
    paths = {
        measurement: _path(measurement, flown[recording], folder)
        for recording in recordings
        for measurement in unique
        if measurement.recording == recording
    }
    make_folder(folder)
    with locked(folder, lambda text: None):
        atomic.sweep(folder)
        waiting = {m: path for m, path in paths.items() if not path.exists()}
        flights = [
            DataFile(block.rows(folder), partial(block.fly, folder), len(block.scenes))
            for recording in dict.fromkeys(measurement.recording for measurement in waiting)
            for block in flown[recording]
            if not block.rows(folder).exists()
        ]
        tables = [  # a measurement takes about as long as a flight
            DataFile(
                path, partial(_measure, measurement, flown[measurement.recording], folder, path)
            )
            for measurement, path in waiting.items()
        ]
        make_missing((flights, tables), workers, progress)
    return EvidenceTable({m: read_evidence(paths[m])[m] for m in unique})


@arithmetic()
def _measure(measurement: Measurement, flown: Blocks, folder: Path, path: Path) -> None:
    values = measured(measurement, recorded(flown, folder))
    write_evidence(path, EvidenceTable({measurement: values}))


def _path(measurement: Measurement, flown: Blocks, folder: Path) -> Path:
    stems = tuple(block.stem for block in flown)
    content = repr((measurement.key(), stems, code_of("faultpath_paper")))
    return folder / f"{hashlib.sha256(content.encode()).hexdigest()[:24]}.measured.parquet"
