"""Measuring: record what is missing, measure what is missing, and keep both."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from faultpath.evidence import EvidenceTable, Measurement, Progress
from faultpath.quadrotor.device import arithmetic
from faultpath.quadrotor.evidence.quantities import check, measured
from faultpath.quadrotor.evidence.recording import Block, Recorded, blocks, recorded
from faultpath.quadrotor.training.provenance import code_of
from faultpath.store import atomic, make_folder
from faultpath.store.evidence import read_evidence, write_evidence
from faultpath.store.lock import locked
from faultpath.work import local, run_all


@dataclass(frozen=True)
class Flying:
    """A block that is not stored yet."""

    block: Block
    folder: Path

    @property
    def flights(self) -> int:
        """What it counts for in the progress."""
        return len(self.block.scenes)

    @arithmetic()
    def run(self) -> None:
        """Fly it and store it."""
        self.block.fly(self.folder)


@dataclass(frozen=True)
class Measuring:
    """A measurement, the blocks that it is made on, and where it is stored."""

    measurement: Measurement
    blocks: tuple[Block, ...]
    folder: Path

    flights: int = 1
    """What it counts for in the progress: about as long as a flight."""

    @property
    def path(self) -> Path:
        """Its file, named by a hash of everything that decides the numbers."""
        content = (
            self.measurement.key(),
            tuple(block.stem for block in self.blocks),
            code_of("evidence.measuring"),
        )
        name = hashlib.sha256(repr(content).encode()).hexdigest()[:24]
        return self.folder / f"{name}.measured.parquet"

    @arithmetic()
    def run(self) -> None:
        """Measure it and store it."""
        found = measured(self.measurement, _recorded(self.blocks, self.folder))
        write_evidence(self.path, EvidenceTable({self.measurement: found}))


def measure(
    measurements: Sequence[Measurement],
    scenes: int | None,
    folder: Path,
    workers: int = 0,
    progress: Progress | None = None,
) -> EvidenceTable:
    """Measure the quadrotor on recorded windows; see `faultpath.evidence.Measurer`."""
    tell = progress or (lambda done, total: None)
    asked = tuple(dict.fromkeys(measurements))
    for measurement in asked:
        check(measurement)
    recordings = dict.fromkeys(measurement.recording for measurement in asked)
    flown = {recording: blocks(recording, scenes) for recording in recordings}
    # One recording after the other: a worker keeps the windows of the one that it is at.
    jobs = [
        Measuring(measurement, flown[recording], folder)
        for recording in recordings
        for measurement in asked
        if measurement.recording == recording
    ]
    make_folder(folder)
    with locked(folder, lambda text: None):
        atomic.sweep(folder)
        waiting = [job for job in jobs if not job.path.exists()]
        missing = [
            Flying(block, folder)
            for recording in dict.fromkeys(job.measurement.recording for job in waiting)
            for block in flown[recording]
            if not block.stored(folder)
        ]
        total, done = sum(job.flights for job in (*missing, *waiting)), 0
        tell(done, total)
        with local(workers) as executor:
            for stage in (missing, waiting):
                for place, _ in run_all(executor, [job.run for job in stage]):
                    done += stage[place].flights
                    tell(done, total)
    found = {job.measurement: read_evidence(job.path).values(job.measurement) for job in jobs}
    return EvidenceTable({measurement: found[measurement] for measurement in asked})


@lru_cache(maxsize=1)
def _recorded(blocks: tuple[Block, ...], folder: Path) -> Recorded:
    return recorded(blocks, folder)
