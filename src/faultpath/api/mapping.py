"""`faultpath.reversal_map`: run two errors of one source against each other, decide, report."""

from os import PathLike
from typing import Any

from faultpath.api.display import Display
from faultpath.api.job import asks
from faultpath.api.running import run
from faultpath.api.runs import MapRun
from faultpath.decisions.map.study import plan_map
from faultpath.trials import System
from faultpath.trials.question import MapQuestion


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
    return run("reversal_map", MapQuestion, plan_map, MapRun, system, arguments, progress)
