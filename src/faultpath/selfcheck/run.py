"""Carrying the simulations out: which, how many, on how many processes."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from faultpath.errors import UserError
from faultpath.selfcheck.audits import equal_grid, reversal_grid, training_grid
from faultpath.selfcheck.coverage import break_even_grid, interval_grid, models_grid
from faultpath.selfcheck.detection import detection_grid
from faultpath.selfcheck.model import Measured, Report, Section
from faultpath.selfcheck.plane import map_grid
from faultpath.selfcheck.populations import SCENES
from faultpath.selfcheck.records import lopsided_grid, record_grid
from faultpath.selfcheck.sequential import any_look_grid, every_look_grid, taken_grid
from faultpath.work import local, run_all

T = TypeVar("T")


class Task(Protocol):
    """One setting of one simulation; the same one always gives the same rates."""

    def measure(self) -> Measured | tuple[Measured, ...]:
        """Simulate it; several rates where one sample gives them."""
        ...


@dataclass(frozen=True)
class Profile:
    """How much is simulated: scenes of the grids, and samples of each kind a setting."""

    scenes: tuple[int, ...]
    intervals: int
    break_even: int
    models: int
    reports: int
    audits: int
    trainings: int
    looks: int
    records: int
    sequential: int

    def tasks(self) -> list[Task]:
        """Return all settings."""
        return [
            *interval_grid(self.scenes, self.intervals),
            *break_even_grid(self.scenes, self.break_even),
            *models_grid(self.models),
            *detection_grid(self.reports),
            *equal_grid(self.audits),
            *reversal_grid(self.audits),
            *training_grid(self.trainings),
            *lopsided_grid(self.audits),
            *record_grid(self.records),
            *any_look_grid(self.looks),
            *every_look_grid(self.sequential),
            *taken_grid(self.sequential),
        ]


PROFILES = {
    "full": Profile(SCENES, 20_000, 4_000, 500, 60, 1_000, 2_000, 400, 100, 2_000),
    "medium": Profile(SCENES, 4_000, 800, 150, 8, 300, 600, 50, 25, 300),
    "quick": Profile((25,), 500, 200, 20, 1, 10, 30, 4, 1, 20),
}
MAPS = {
    "full": ((10, 25, 50, 100), 500),
    "medium": ((10, 25, 50, 100), 100),
    "quick": ((25,), 10),
}
"""Of maps: numbers of scenes, and maps of each kind."""
_EACH = 8
"""Settings that are worth starting a process for."""

Progress = Callable[[int, int, float | None], None]
"""Told how many settings are done, of how many, and the seconds left as far as known."""


def check_statistics(profile: str, processes: int = 1, progress: Progress | None = None) -> Report:
    """Simulate everything that ``profile`` holds, on no more processes than it can keep busy.

    One process is this one itself. `UserError` for an unknown profile.
    """
    tasks = _known(profile, PROFILES).tasks()
    return _simulated(profile, tasks, processes, progress)


def check_map(profile: str, processes: int = 1, progress: Progress | None = None) -> Report:
    """Simulate reversal maps as `check_statistics` does audits."""
    tasks = map_grid(*_known(profile, MAPS))
    return _simulated(profile, list(tasks), processes, progress)


def _known(profile: str, profiles: Mapping[str, T]) -> T:
    if profile not in profiles:
        raise UserError(f"there is no profile '{profile}': choose {', '.join(profiles)}.")
    return profiles[profile]


def _simulated(
    profile: str, tasks: Sequence[Task], processes: int, progress: Progress | None
) -> Report:
    start = time.perf_counter()
    # The slow ones stand at the end; mixed, the time left can be told from what is done.
    order = sorted(range(len(tasks)), key=lambda i: (i * 7919) % len(tasks))
    found: dict[int, Measured | tuple[Measured, ...]] = {}

    most = math.ceil(len(tasks) / _EACH)
    with local(min(processes, most) if processes > 1 else 0) as executor:
        for place, measured in run_all(executor, [tasks[index].measure for index in order]):
            found[order[place]] = measured
            if progress is not None:
                spent = time.perf_counter() - start
                left = spent * (len(tasks) - len(found)) / len(found) if len(found) > 20 else None
                progress(len(found), len(tasks), left)
    rates = (found[index] for index in range(len(tasks)))
    done = [one for each in rates for one in (each if isinstance(each, tuple) else (each,))]
    return Report(
        profile=profile,
        seconds=round(time.perf_counter() - start, 1),
        sections=tuple(_section(name, done) for name in dict.fromkeys(m.section for m in done)),
    )


def _section(name: str, done: Sequence[Measured]) -> Section:
    mine = [each for each in done if each.section == name]
    return Section(
        name=name,
        columns=(*mine[0].setting, "measured", "runs"),
        rows=tuple((*each.setting.values(), round(each.rate, 5), each.runs) for each in mine),
    )
