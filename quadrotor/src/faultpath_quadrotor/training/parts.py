"""Files that are made one by one, by worker processes, where they are not there yet."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from faultpath.plugin.work import local, run_all

CLEARANCE_POOL, TRAJECTORY_POOL = "clearance", "trajectory"

Progress = Callable[[float, float], None]
"""Called with the amount done and the total; its first call counts existing files."""


@dataclass(frozen=True)
class DataFile:
    """A file and the function that makes it; it counts as made once the file exists."""

    path: Path
    make: Callable[[], None]
    """A function of a module bound to its arguments, so that a worker process can call it."""
    size: int = 1
    """Its weight in the progress."""


def make_missing(
    stages: Sequence[Sequence[DataFile]], workers: int, progress: Progress | None
) -> None:
    """Make what is missing, one stage after the other, with so many processes (0: this one).

    Raises the error of the first part that fails.
    """
    report = progress or (lambda done, total: None)
    missing = [[part for part in stage if not part.path.exists()] for stage in stages]
    total = sum(part.size for stage in stages for part in stage)
    done = total - sum(part.size for stage in missing for part in stage)
    report(done, total)
    with local(workers) as executor:
        for stage in missing:
            for place, _ in run_all(executor, [part.make for part in stage]):
                done += stage[place].size
                report(done, total)
