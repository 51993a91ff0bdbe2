"""`faultpath.map` and `faultpath.scan`: analyses whose next trials follow from those before."""

from functools import partial
from os import PathLike
from typing import Any, TypeVar

from faultpath.analyses.analysis import Analysis
from faultpath.analyses.map.analysis import map_analysis
from faultpath.analyses.scan.analysis import ranked_sources, scan_analysis
from faultpath.analyses.scan.sources import Ranking
from faultpath.api.display import Display
from faultpath.api.folders import as_text
from faultpath.api.job import Job, begin, run, with_question_signature
from faultpath.api.runs import MapRun, ScanRun
from faultpath.core.files.atomic import write_text
from faultpath.run.question import MapCall, ScanCall
from faultpath.system.system import System

_Finished = TypeVar("_Finished", MapRun, ScanRun)


@with_question_signature(MapCall)
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
    finish = partial(_finished, MapRun)
    return run("map", MapCall, map_analysis, finish, system, arguments, progress)


@with_question_signature(ScanCall)
def scan(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> ScanRun | Ranking:
    """Find which errors of a system's inputs cancel: each alone costs more than both together.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    Without `trials` it returns the sources that may err, ranked, and runs no trial.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    if not arguments.get("trials", True):
        question, chosen, library, _ = begin("scan", ScanCall, system, arguments, progress)
        return ranked_sources(chosen.system, question, library)
    finish = partial(_finished, ScanRun)
    return run("scan", ScanCall, scan_analysis, finish, system, arguments, progress)


def _finished(kind: type[_Finished], analysis: Analysis[Any], job: Job) -> _Finished:
    """Run the rounds of an analysis, conclude, and write its result."""
    items, result = job.trials(analysis)
    record = analysis.conclude(result.trials, result.deliveries, items)
    write_text(job.folder / kind.files[0], as_text(record), job.folder)
    return kind(job.folder, record, job.finish(result, analysis.system, kind.files))
