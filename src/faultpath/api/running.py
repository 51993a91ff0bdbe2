"""One way for audits, maps, searches and sensitivity analyses, from a call to a finished run."""

import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from faultpath.api.display import Display
from faultpath.api.job import Job, begin
from faultpath.api.runs import MapRun, Run, SearchRun, SensitivityRun, open_run
from faultpath.api.systems import Chosen, executor_of
from faultpath.core.errors import UserError
from faultpath.decisions.analysis import Analysis
from faultpath.trials import Library, System, SystemSpec
from faultpath.trials.code import system_code
from faultpath.trials.question import Running, SensitivityQuestion
from faultpath.trials.store.folder import keyed

_LONGEST_NAME = 180
"""Longest name of a run folder; file systems take 255 bytes."""

_Request = TypeVar("_Request", bound=Running | SensitivityQuestion)
_Finished = TypeVar("_Finished", bound=Run | MapRun | SearchRun | SensitivityRun)


def run(
    call: str,
    model: type[_Request],
    plan: Callable[[System, SystemSpec, _Request, Library], Analysis[Any]],
    kind: type[_Finished],
    system: str | PathLike[str] | System,
    arguments: Mapping[str, object],
    progress: bool | Display,
    carry_out: Callable[[Any, Job], object] | None = None,
) -> _Finished:
    """Read a question, plan its trials, run them, conclude, and write record and pages.

    `call` is the name of the function; `carry_out` does what lies between plan and pages, by
    default that of an analysis of which nothing but a record is kept.

    Raises `UserError` for what cannot be done, and `Stopped` on Ctrl-C.
    """
    request, chosen, library, display = begin(call, model, system, arguments, progress)
    analysis = plan(chosen.system, chosen.spec, request, library)
    place = run_folder(request, chosen, analysis.named)
    with executor_of(chosen.system, chosen.workers, chosen.executor) as executor:
        job = Job(place, executor, display, {"time_limit_s": request.time_limit_s})
        if carry_out is not None:
            carry_out(analysis, job)
        else:
            items, result = job.trials(analysis)
            record = analysis.conclude(result.outcomes, result.deliveries, items)
            job.keep(record, result, analysis.system, kind.files)
    finished = open_run(place)
    assert isinstance(finished, kind)
    finished.report()
    return finished


def run_folder(
    question: Running | SensitivityQuestion, chosen: Chosen, named: Sequence[str]
) -> Path:
    """Return the folder of a run.

    Without a folder of the caller's it is named after everything that makes it another study,
    which begins with `named`, and after the code as it is; of an absolute path, which says more of
    the machine than of the study, a digest stands for the folders. `UserError` for one that holds a
    run of an object, which may have been another.
    """
    parts = [*named, *(f"{key}-{value}" for key, value in sorted(chosen.spec.options.items()))]
    if question.scenes is not None:
        parts.append(f"{question.scenes}-scenes")
    if question.seeds != (0,):
        parts.append(f"seeds-{','.join(map(str, question.seeds))}")
    joined = "-".join(parts)
    short = re.sub(r"(?:^|(?<=[:,=-]))/(?:[^/:,]*/)*", "", joined)
    if short != joined:
        short = f"{short}-{hashlib.sha256(joined.encode()).hexdigest()[:8]}"
    name = re.sub(r"[^A-Za-z0-9.+=,_-]+", "_", short).strip("._")
    if len(name) > _LONGEST_NAME:
        name = f"{name[:_LONGEST_NAME]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
    if question.folder is None and not chosen.own:
        return keyed(Path("runs"), name, system_code(chosen.system, chosen.spec).state)
    stamp = datetime.now().strftime("%Y%m%d-%H%M%S-%f")
    place = question.folder or Path("runs") / f"{name}-{stamp}"
    if chosen.own and (place / "manifest.json").exists():
        raise UserError(
            f"{place} holds a run, and whether it was of this same object cannot be told: give "
            "another folder, or put what builds the system into a file and name that."
        )
    return place
