"""`faultpath.reversal_map`: run two errors of one source against each other, decide, report."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.api.asking import asked_for, asks, begin
from faultpath.api.audit import run_folder
from faultpath.api.display import Display
from faultpath.api.systems import hands
from faultpath.decisions.map.study import plan_map
from faultpath.trials import System
from faultpath.trials.question import MapQuestion

if TYPE_CHECKING:
    from faultpath.api.run import MapRun


@asks(MapQuestion)
def reversal_map(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **given: Any
) -> "MapRun":
    """Map who is ahead over the error at one module and that at another, of the same source.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **given: ...

    The same folder serves another spread or number of points, and keeps what was run.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    asked = asked_for(MapQuestion, given, progress)
    begun = begin("reversal_map", system, asked, progress)
    chosen, told = begun.chosen, begun.told
    plan = plan_map(chosen.system, chosen.spec, asked, begun.library)
    found = plan.question
    named = [plan.name, asked.fault, *found.against, f"{found.up_to:g}", Path(asked.library).stem]
    place = run_folder(asked, chosen, named)
    if chosen.notice:
        told.say(chosen.notice)

    # What runs and draws takes a while to load, and no mistake so far waits for it.
    from faultpath.api.job import Job
    from faultpath.api.map_flying import fly_map
    from faultpath.api.run import MapRun

    with hands(chosen.system, chosen.workers, chosen.executor) as workforce:
        job = Job(place, workforce, told, asked.time_limit_s)
        run = MapRun(place, *fly_map(plan, job))
    run.report()
    return run
