"""`faultpath.map`: many errors of one source."""

from os import PathLike
from typing import Any

from faultpath.analyses.map.analysis import MapAnalysis, map_analysis
from faultpath.api.display import Display
from faultpath.api.folders import MAP, MAP_MADE_FROM, as_text
from faultpath.api.job import Job, run, with_question_signature
from faultpath.api.runs import MapRun
from faultpath.core.files.atomic import write_text
from faultpath.run.question import MapCall
from faultpath.system.system import System


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
    return run("map", MapCall, map_analysis, _map, system, arguments, progress)


def _map(analysis: MapAnalysis, job: Job) -> MapRun:
    """Run the trials of a map, conclude, and write the record.

    Raises `Stopped` on Ctrl-C, and `UserError` where the trials cannot be run.
    """
    points, result = job.trials(analysis)
    record = analysis.conclude(result.trials, result.deliveries, points)
    write_text(job.folder / MAP, as_text(record), job.folder)
    return MapRun(job.folder, record, job.finish(result, analysis.system, MAP_MADE_FROM))
