"""`faultpath.reproduce`: the paper's tables, figures and claims, flown again."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from faultpath.api.display import Display, display
from faultpath_quadrotor.paper.reproduced import ReproductionRun
from faultpath.api.systems import LOCAL, check_executor, hands
from faultpath_quadrotor.paper.run import plan


def reproduce(
    pages: str | Sequence[str] = (),
    *,
    profile: str = "quick",
    folder: str | PathLike[str] | None = None,
    workers: int | None = None,
    device: str | None = None,
    time_limit_s: float | None = None,
    progress: bool | Display = True,
    executor: str = LOCAL,
) -> ReproductionRun:
    """Fly every study of the paper, or some of its pages, and compare the results with it.

    Args:
        pages: `table-4`, `figure-3`, `text` and so on; default all.
        profile: `quick` (few scenes, one seed) or `paper` (its size).
        folder: Run folder; default `runs/reproduction-<profile>-<code>`.
        workers: Worker processes, 0 for this process alone; default one per core, or per GPU.
        device: `cpu` (default) or `cuda`.
        time_limit_s: Seconds that a block of scenes may take in a worker.
        progress: As in `audit`.
        executor: As in `audit`, for the flights; windows are measured on this machine.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    given = dict(locals())
    check_executor(executor)
    named = (pages,) if isinstance(pages, str) else tuple(pages)
    asked = plan(named, profile, {} if device is None else {"device": device})
    place = Path(folder) if folder else asked.folder(f"reproduction-{asked.profile.name}")
    told = display(progress, "reproduce", given | {"pages": named})

    # What flies, stores and draws takes a while to load, and no mistake so far waits for it.
    from faultpath.api.job import Job
    from faultpath_quadrotor.paper.reproducing import carry_out

    with hands(asked.system, workers, executor) as workforce:
        return carry_out(asked, Job(place, workforce, told, time_limit_s))
