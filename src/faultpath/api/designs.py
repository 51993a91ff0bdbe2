"""`faultpath.map`, `faultpath.api.search` and `sensitivity`: many faults of one system."""

from functools import partial
from os import PathLike
from typing import Any, TypeVar

from faultpath.api.audit import carry_out
from faultpath.api.display import Display
from faultpath.api.job import Job, asks, run
from faultpath.api.runs import MapRun, SearchRun, SensitivityRun
from faultpath.core.results import Result
from faultpath.decisions.analysis import Analysis
from faultpath.decisions.map.study import plan_map
from faultpath.decisions.search.decide import best
from faultpath.decisions.search.study import SearchPlan, digest, plan_search
from faultpath.decisions.sensitivity.study import plan_sensitivity
from faultpath.trials import System
from faultpath.trials.execution.runner import RunResult
from faultpath.trials.question import MapQuestion, SearchQuestion, SensitivityQuestion
from faultpath.trials.store.atomic import write_text

_Kind = TypeVar("_Kind", bound=MapRun | SearchRun | SensitivityRun)


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
    decide = partial(_decide, MapRun)
    return run("map", MapQuestion, plan_map, decide, system, arguments, progress)


@asks(SearchQuestion)
def search(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> SearchRun:
    """Look for the fault that hurts those most who choose the repair by an isolated audit.

    Half of the scenes find it, and test nothing; an ordinary audit of that one fault in the other
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
    return run("api.search", SearchQuestion, plan_search, _search, system, arguments, progress)


def _search(plan: SearchPlan, job: Job) -> SearchRun:
    """Try faults, audit the best, and write the record.

    Raises `Stopped` on Ctrl-C, and `UserError` where the trials cannot be run.
    """
    tried, result = job.trials(plan)
    confirmed, folder, failed = None, "", 0
    if chosen := best(tried):
        folder = f"confirmation-{digest(chosen)}"
        job.display.say(f"Chosen: {chosen}. The audit that follows tests it.")
        audit = Job(job.folder / folder, job.executor, job.display, job.how)
        confirming = carry_out(plan.audit(chosen), audit)
        confirming.report()
        confirmed, failed = confirming.record, confirming.failed
    record = plan.conclude(result.outcomes, result.deliveries, tried, confirmed, folder, failed)
    return _finished(SearchRun, record, result, plan.system, job)


@asks(SensitivityQuestion)
def sensitivity(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> SensitivityRun:
    """Rank declared uncertainties by how much they move what a variant achieves: Sobol indices.

    Each draw of all errors is a condition, with each error at all who read its source.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    The same call resumes, and ends with the same bytes.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    decide = partial(_decide, SensitivityRun)
    call = "api.sensitivity"
    return run(call, SensitivityQuestion, plan_sensitivity, decide, system, arguments, progress)


def _decide(kind: type[_Kind], analysis: Analysis[Any], job: Job) -> _Kind:
    """Run the trials of an analysis, conclude, and write the record; raises as `_search`."""
    items, result = job.trials(analysis)
    record = analysis.conclude(result.outcomes, result.deliveries, items)
    return _finished(kind, record, result, analysis.system, job)


def _finished(
    kind: type[_Kind], record: Result, result: RunResult, system: System, job: Job
) -> _Kind:
    """Write a record, and how it was made; return the run."""
    text = record.model_dump_json(indent=1) + "\n"
    write_text(job.folder / kind.files[0], text, job.folder)
    return kind(job.folder, record, job.finish(result, system, kind.files))
