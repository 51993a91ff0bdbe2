"""Pools are flown batch by batch, and joined when all batches are there.

A batch depends on nothing but its pool's recipe and its place, so a run that was killed loses at
most the batches in flight, and the next one goes on there and ends with the same bytes.
"""

import hashlib
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from faultpath.execution.provenance import packages
from faultpath.quadrotor.training.parts import Part, make_missing
from faultpath.quadrotor.training.pool import (
    episodes_path,
    join_flights,
    steps_of,
    write_flights,
)
from faultpath.quadrotor.training.provenance import Provenance, Recipe, provenance_path
from faultpath.quadrotor.training.recorded import Flights
from faultpath.quadrotor.vehicle import CONTROL_DT_S
from faultpath.store import atomic
from faultpath.version import __version__

Progress = Callable[[float, float], None]
"""Called with the episodes done and those in all; its first call counts what was there."""


@dataclass(frozen=True)
class Batch:
    """Episodes that are flown together, and where they are kept until their pool is whole."""

    stem: Path
    episodes: range
    fly: Callable[[], Flights]
    """A function of a module bound to its arguments, so that a worker process can call it."""

    def make(self) -> None:
        """Fly and write them; `OSError` when the disk will not."""
        write_flights(self.stem, self.episodes, self.fly())


def make_pools(
    pools: Mapping[Path, tuple[Recipe, Sequence[Batch]]],
    workers: int,
    progress: Progress | None,
    whole: int = 0,
) -> None:
    """Fly the batches that are missing of pools, by the files of their rows, and join them.

    An episode with fewer than `whole` control steps has ended early.
    """
    every = [batch for _, batches in pools.values() for batch in batches]
    for place in {batch.stem.parent for batch in every}:
        place.mkdir(parents=True, exist_ok=True)
        atomic.sweep(place)
    parts = [Part(Path(f"{each.stem}.rows"), each.make, len(each.episodes)) for each in every]
    make_missing([parts], workers, progress)
    for path, (recipe, batches) in pools.items():
        _join(path, recipe, [batch.stem for batch in batches], whole)
        for place in path.parent.glob(f".{recipe.pool}-*"):  # also of recipes that are no more
            shutil.rmtree(place)


def _join(path: Path, recipe: Recipe, stems: Sequence[Path], whole: int) -> None:
    """Write a finished pool, its provenance last."""
    rows, episodes = join_flights(stems)
    steps = steps_of(episodes)
    provenance = Provenance(
        **dict(recipe),
        faultpath_version=__version__,
        packages=packages(),
        rows=int(steps.sum()) + len(steps),
        vehicle_seconds=round(float(steps.sum()) * CONTROL_DT_S, 3),
        ended_early=int((steps < whole).sum()),
        rows_sha256=hashlib.sha256(rows).hexdigest(),
        episodes_sha256=hashlib.sha256(episodes).hexdigest(),
    )
    atomic.write(episodes_path(path), episodes)
    atomic.write(path, rows)
    atomic.write(provenance_path(path), provenance.encode())
