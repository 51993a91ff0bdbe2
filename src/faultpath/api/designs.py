"""`faultpath.map`, `faultpath.api.search` and `sensitivity`: many faults of one system."""

from os import PathLike
from typing import Any

from faultpath.api.audit import carry_out
from faultpath.api.display import Display
from faultpath.api.folders import read_run
from faultpath.api.job import Job, asks
from faultpath.api.running import run
from faultpath.api.runs import MapRun, Run, SearchRun, SensitivityRun
from faultpath.decisions.map.study import plan_map
from faultpath.decisions.search.decide import best
from faultpath.decisions.search.study import SearchPlan, digest, plan_search
from faultpath.decisions.sensitivity.study import plan_sensitivity
from faultpath.trials import System
from faultpath.trials.question import MapQuestion, SearchQuestion, SensitivityQuestion


@asks(MapQuestion)
def map(
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
    return run("map", MapQuestion, plan_map, MapRun, system, arguments, progress)


@asks(SearchQuestion)
def search(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> SearchRun:
    """Look for the fault that hurts those most who choose the repair by an isolated audit.

    Half of the scenes find it, and decide nothing; an ordinary audit of that one fault in the other
    half does.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    The same call resumes, and ends with the same bytes.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    return run(
        "api.search",
        SearchQuestion,
        plan_search,
        SearchRun,
        system,
        arguments,
        progress,
        _carry_out,
    )


def _carry_out(plan: SearchPlan, job: Job) -> None:
    """Try faults, audit the best, and write the record.

    Raises `Stopped` on Ctrl-C, and `UserError` where the trials cannot be run.
    """
    tried, result = job.trials(plan)
    confirmed, folder, failed = None, "", 0
    if chosen := best(tried):
        folder = f"confirmation-{digest(chosen)}"
        job.display.say(f"Chosen: {chosen}. What follows decides.")
        audit = Job(job.folder / folder, job.executor, job.display, job.how)
        carry_out(plan.audit(chosen), audit)
        confirming = Run(audit.folder, *read_run(audit.folder))
        confirming.report()
        confirmed, failed = confirming.record, confirming.failed
    record = plan.conclude(result.outcomes, result.deliveries, tried, confirmed, folder, failed)
    job.keep(record, result, plan.system, SearchRun.files)


@asks(SensitivityQuestion)
def sensitivity(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> SensitivityRun:
    """Tell which declared uncertainty moves what a variant achieves: Sobol indices of groups.

    One arm is one draw of all errors, each at all who read its source.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    The same call resumes, and ends with the same bytes.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    return run(
        "api.sensitivity",
        SensitivityQuestion,
        plan_sensitivity,
        SensitivityRun,
        system,
        arguments,
        progress,
    )
