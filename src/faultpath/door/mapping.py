"""`faultpath.reversal_map`: fly two errors of one source against each other, decide, report."""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from faultpath.door.audit import (
    between_runs,
    checked_count,
    checked_seeds,
    checked_texts,
    run_folder,
)
from faultpath.door.display import Display, display
from faultpath.door.systems import LOCAL, choose, hands
from faultpath.plane.study import plan_map
from faultpath.setup_limit import setup_limit
from faultpath.trials import System, library_of

if TYPE_CHECKING:
    from faultpath.door.run import MapRun


def reversal_map(
    system: str | PathLike[str] | System,
    *,
    baseline: str,
    repair: str,
    fault: str,
    against: str | Sequence[str],
    up_to: float | None = None,
    points: int = 81,
    mean: float | Sequence[float] = 0.0,
    spread: float | Sequence[float] | None = None,
    correlation: float | None = None,
    library: str = "held-out",
    scenes: int | None = None,
    seeds: int | Sequence[int] = 0,
    options: Mapping[str, object] | None = None,
    folder: str | PathLike[str] | None = None,
    workers: int | None = None,
    time_limit_s: float | None = None,
    progress: bool | Display = True,
    executor: str = LOCAL,
    share: str | PathLike[str] | None = None,
) -> "MapRun":
    """Map who is ahead over the error at one module and that at another, of the same source.

    Args:
        system: As for `audit`.
        baseline: Variant to compare with.
        repair: Variant that is meant to help.
        fault: Without its size: a preset (`calibration`), a channel (`gain`, relative errors) or
            `CHANNEL:offset`; options may follow (`gain:scale,onset=20`).
        against: The two modules, as a list or as the text of the command (`"controller,observer"`).
        up_to: Largest error, of either sign; default three of the spreads that the interface
            declares.
        points: Pairs of errors to fly at most, but for those that bisect the paths of the fault.
        mean: Means of the errors under which the expected difference is taken, one or two.
        spread: Their standard deviations; default what the interface declares, else half of
            `up_to`.
        correlation: Correlation at which the expected difference is told, beside 0 and 1.
        library: Library of scenes, by name or file.
        scenes: How many of its first scenes; `None` for all.
        seeds: Seeds of the noise, and of trained models where there are any.
        options: The system's own options.
        folder: Run folder; the same one serves another spread or number of points, and keeps what
            was flown.
        workers: Worker processes, 0 for this process alone.
        time_limit_s: Seconds that a block of scenes may take in a worker.
        progress: As for `audit`.
        executor: As for `audit`.
        share: As for `audit`, with which a map has correct inputs, isolated and shared faults in
            common.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    against = against.split(",") if isinstance(against, str) else against
    against = tuple(each.strip() for each in against)
    given = dict(locals())
    checked_texts(baseline=baseline, repair=repair, fault=fault, library=library)
    drawn, count = checked_seeds(seeds), checked_count("scenes", scenes)
    called = isinstance(progress, Display) and progress.is_command
    with setup_limit(str(system), time_limit_s) if called else nullcontext():
        chosen = choose(system, options or {}, workers, (baseline, repair), executor)
        built = chosen.system
        scenes_from = library_of(built, library)
    plan = plan_map(
        built,
        chosen.spec,
        baseline=baseline,
        repair=repair,
        fault=fault,
        against=against,
        library=scenes_from,
        up_to=up_to,
        points=points,
        means=_numbers(mean),
        spreads=None if spread is None else _numbers(spread),
        correlation=correlation,
        scenes=count,
        seeds=drawn,
    )
    said = {"system": chosen.spec.name, "options": chosen.spec.options}
    told = display(progress, "reversal_map", given | said)
    named = [plan.name, fault, *plan.question.against, f"{plan.question.up_to:g}", library]
    place = run_folder(folder, chosen, [*named[:-1], Path(library).stem], count, drawn)
    if chosen.notice:
        told.say(chosen.notice)

    # What flies and draws takes a while to load, and no mistake so far waits for it.
    from faultpath.door.job import Job
    from faultpath.door.map_flying import fly_map
    from faultpath.door.run import MapRun

    with hands(built, chosen.workers, chosen.executor) as workforce:
        between = between_runs(share, folder, executor)
        run = MapRun(place, *fly_map(plan, Job(place, workforce, told, time_limit_s, between)))
    run.report()
    return run


def _numbers(value: float | Sequence[float]) -> tuple[float, ...]:
    return (float(value),) if isinstance(value, int | float) else tuple(map(float, value))
