"""`faultpath.reversal_map`: run two errors of one source against each other, decide, report."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from faultpath.api.audit import run_folder
from faultpath.api.display import Display
from faultpath.api.folders import MAP, MAP_MADE_FROM
from faultpath.api.job import Job, asks, begin
from faultpath.api.runs import MapRun
from faultpath.api.systems import executor_of
from faultpath.decisions.map.decide import conclude
from faultpath.decisions.map.lattice import COARSE, Point, lattice
from faultpath.decisions.map.study import MapPlan, plan_map
from faultpath.decisions.map.surface import next_points
from faultpath.trials import OutcomeTable, System
from faultpath.trials.question import MapQuestion
from faultpath.trials.store.atomic import write_text

_BISECTING = 18
"""Points that are typically added to bisect the paths of the fault."""


@asks(MapQuestion)
def reversal_map(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> MapRun:
    """Map who is ahead over the error at one module and that at another, of the same source.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    The same folder serves another spread or number of points, and keeps what was run.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    request, chosen, library, display = begin(
        "reversal_map", MapQuestion, system, arguments, progress
    )
    plan = plan_map(chosen.system, chosen.spec, request, library)
    question = plan.question
    named = [
        plan.study(()).name,
        request.fault,
        *question.against,
        f"{question.up_to:g}",
        Path(request.library).stem,
    ]
    place = run_folder(request, chosen, named)
    with executor_of(chosen.system, chosen.workers, chosen.executor) as executor:
        run = _carry_out(
            plan, Job(place, executor, display, {"time_limit_s": request.time_limit_s})
        )
    run.report()
    return run


def _carry_out(plan: MapPlan, job: Job) -> MapRun:
    """Run the points of a map, round after round, each from what those before have shown; decide,
    and write what its pages are made from.

    Raises `Stopped` on Ctrl-C, and `UserError` where nothing is left to compare.
    """
    question, points, display = plan.question, lattice(COARSE), job.display
    if plan.system.backend:
        display.say(f"Computing with {plan.system.backend}.")
    study = plan.study(points)
    first = len(study.rows) * len(plan.scenes)
    most = max(len(points), question.points + _BISECTING) / len(points)
    display.say(
        f"{len(points)} pairs of errors first, {first} trials; then more where the sign is not "
        f"decided, about {round(first * most)} trials at most."
    )

    def more(points: Sequence[Point], table: OutcomeTable) -> Sequence[Point]:
        differences, _ = plan.differences(points, table)
        return next_points(differences, question.against, question.points, question.library_hash)

    points, result = job.rounds(
        plan.system, points, plan.study, more, question.points + _BISECTING, "pairs of errors"
    )
    record = conclude(plan, points, result.outcomes, result.findings)
    write_text(job.folder / MAP, record.model_dump_json(indent=1) + "\n", job.folder)
    return MapRun(job.folder, record, job.finish(result, plan.system, MAP_MADE_FROM))
