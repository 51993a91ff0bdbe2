"""Measuring: record what is missing, measure what is missing, and keep both."""

import hashlib
from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path

from faultpath.trials.store import atomic, make_folder
from faultpath.trials.store.atomic import locked
from faultpath_quadrotor.device import arithmetic
from faultpath_quadrotor.evidence.quantities import check, measured
from faultpath_quadrotor.evidence.recording import Block, Recorded, blocks, recorded
from faultpath_quadrotor.evidence.table import (
    EvidenceTable,
    Measurement,
    Progress,
    read_evidence,
    write_evidence,
)
from faultpath_quadrotor.training.parts import Part, make_missing
from faultpath_quadrotor.training.provenance import code_of

Blocks = tuple[Block, ...]


def measure(
    measurements: Sequence[Measurement],
    scenes: int | None,
    folder: Path,
    workers: int = 0,
    progress: Progress | None = None,
) -> EvidenceTable:
    """Record what is missing, measure what is missing, and return all of `measurements`.

    Args:
        measurements: What to measure; one that stands there twice is measured once.
        scenes: The first N scenes of each library; `None`: all.
        folder: Where recordings and measurements are kept, so that the next call goes on.
        workers: Processes; 0: everything is done in this one.
        progress: Is told how far it is.

    Raises:
        UserError: A library, variant, option or fault does not exist or does not fit.
    """
    asked = tuple(dict.fromkeys(measurements))
    for measurement in asked:
        check(measurement)
    recordings = dict.fromkeys(measurement.recording for measurement in asked)
    flown = {recording: blocks(recording, scenes) for recording in recordings}
    # One recording after the other: a worker keeps the windows of the one that it is at.
    paths = {
        measurement: _path(measurement, flown[recording], folder)
        for recording in recordings
        for measurement in asked
        if measurement.recording == recording
    }
    make_folder(folder)
    with locked(folder, lambda text: None):
        atomic.sweep(folder)
        waiting = {found: path for found, path in paths.items() if not path.exists()}
        flights = [
            Part(block.rows(folder), partial(_fly, block, folder), len(block.scenes))
            for recording in dict.fromkeys(measurement.recording for measurement in waiting)
            for block in flown[recording]
            if not block.rows(folder).exists()
        ]
        tables = [  # a measurement takes about as long as a flight
            Part(path, partial(_measure, found, flown[found.recording], folder, path))
            for found, path in waiting.items()
        ]
        make_missing((flights, tables), workers, progress)
    return EvidenceTable({found: read_evidence(paths[found]).values(found) for found in asked})


@arithmetic()
def _fly(block: Block, folder: Path) -> None:
    block.fly(folder)


@arithmetic()
def _measure(measurement: Measurement, flown: Blocks, folder: Path, path: Path) -> None:
    found = measured(measurement, _recorded(flown, folder))
    write_evidence(path, EvidenceTable({measurement: found}))


def _path(measurement: Measurement, flown: Blocks, folder: Path) -> Path:
    stems = tuple(block.stem for block in flown)
    content = repr((measurement.key(), stems, code_of("evidence.measuring")))
    return folder / f"{hashlib.sha256(content.encode()).hexdigest()[:24]}.measured.parquet"


@lru_cache(maxsize=1)
def _recorded(flown: Blocks, folder: Path) -> Recorded:
    return recorded(flown, folder)
