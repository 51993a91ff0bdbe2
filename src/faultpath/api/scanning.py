"""`faultpath.scan`: which errors of the inputs of a system cancel."""

from os import PathLike
from typing import Any

from faultpath.analyses.scan.analysis import ScanAnalysis, ranked_sources, scan_analysis
from faultpath.analyses.scan.sources import Ranking
from faultpath.api.display import Display
from faultpath.api.folders import SCAN, SCAN_MADE_FROM, as_text
from faultpath.api.job import Job, begin, run, with_question_signature
from faultpath.api.runs import ScanRun
from faultpath.core.files.atomic import write_text
from faultpath.run.question import ScanCall
from faultpath.system.system import System


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
    return run("scan", ScanCall, scan_analysis, _scan, system, arguments, progress)


def _scan(analysis: ScanAnalysis, job: Job) -> ScanRun:
    """Run the trials of a scan, conclude, and write the result.

    Raises `Stopped` on Ctrl-C, and `UserError` where the trials cannot be run.
    """
    scanned, result = job.trials(analysis)
    record = analysis.conclude(result.trials, result.deliveries, scanned)
    write_text(job.folder / SCAN, as_text(record), job.folder)
    return ScanRun(job.folder, record, job.finish(result, analysis.system, SCAN_MADE_FROM))
