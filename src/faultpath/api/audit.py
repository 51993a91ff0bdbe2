"""`faultpath.audit`: run the arms of one question, decide, and write the run folder."""

import hashlib
import re
from collections.abc import Sequence
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.api.asking import asked_for, asks, begin
from faultpath.api.display import Display
from faultpath.api.systems import Chosen, hands
from faultpath.core.errors import UserError
from faultpath.decisions.planning import plan_audit
from faultpath.faults import each_size
from faultpath.statistics import IN_FORCE
from faultpath.trials import System
from faultpath.trials.question import AuditQuestion, Running
from faultpath.trials.state import system_code

if TYPE_CHECKING:
    from faultpath.api.run import Run

_LONGEST_NAME = 180
"""Of a run folder; file systems take 255 bytes."""


@asks(AuditQuestion)
def audit(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **given: Any
) -> "Run":
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault.

    Args:
        system: `quadrotor`, `module:attribute`, `file.py:attribute`, a file in which `create`
            builds the system, or a `System`. One that `load_system` gave is built again from its
            name and options, in worker processes too. Any other object runs as it is, in this
            process, and its trials are never taken for those of another call.
        progress: Whether to show progress and notices, in a notebook's cell or on the standard
            error; otherwise notices go to the log `faultpath`.
        **given: ...

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    asked = asked_for(AuditQuestion, given, progress)
    if len(each_size(asked.fault)) > 1:
        raise UserError(f"fault '{asked.fault}' has several sizes: use faultpath.audits.")
    begun = begin("audit", system, asked, progress)
    chosen, told = begun.chosen, begun.told
    laid = plan_audit(chosen.system, chosen.spec, asked, begun.library)

    # What runs, stores and draws takes a while to load, and no mistake so far waits for it.
    from faultpath.api.carrying_out import carry_out
    from faultpath.api.job import Job
    from faultpath.api.run import Run
    from faultpath.trials.store import read_table
    from faultpath.trials.store.folder import OUTCOMES
    from faultpath.trials.store.sealed import read_regular

    place = run_folder(asked, chosen, _named(asked, laid.study.name))
    if chosen.notice:
        told.say(chosen.notice)
    with hands(chosen.system, chosen.workers, chosen.executor) as workforce:
        job = Job(place, workforce, told, asked.time_limit_s)
        held = carry_out(chosen.system, laid, job, asked.signals)
    run = Run(place, held, read_table(read_regular(place / OUTCOMES)))
    run.report()
    return run


@asks(AuditQuestion)
def audits(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **given: Any
) -> "tuple[Run, ...]":
    """Audit a repair under each size of a fault.

    Each size is an audit with a record of its own, which holds within a size; `compare` decides all
    of them as one family.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **given: ...

    The fault has its sizes one after the other, `gain:scale=0.8,0.9,1.1`, or in a range,
    `calibration=-0.2..0.2/9`: nine sizes at equal distances, both ends among them. In `folder` each
    size gets a folder of its own.

    Raises:
        UserError: As `audit`, and for a size given twice.
    """
    runs: list[Run] = []
    asked = asked_for(AuditQuestion, given, progress)
    folder, texts = asked.folder, each_size(asked.fault)
    for number, text in enumerate(texts, 1):
        place = folder / f"size-{number}" if folder and len(texts) > 1 else folder
        runs.append(audit(system, progress=progress, **{**given, "fault": text, "folder": place}))
    return tuple(runs)


def sweep_page(runs: "Sequence[Run]", folder: Path | None) -> Path:
    """Return where the page over all sizes belongs: in `folder`, else beside the runs' own."""
    if folder is not None:
        return folder / "sweep.html"
    first, names = runs[0].folder, "/".join(run.folder.name for run in runs)
    digest = hashlib.sha256(names.encode()).hexdigest()[:8]
    return first.with_name(f"{first.name}+{len(runs) - 1}-sizes-{digest}.html")


def run_folder(asked: Running, chosen: Chosen, named: Sequence[str]) -> Path:
    """Return the folder of a run.

    Without a folder of the caller's it is that of the question, which `named` tells apart, and of
    the code as it is. `UserError` for one that holds a run of an object, which may have been
    another.
    """
    from faultpath.trials.store.manifest import keyed

    name = _name(asked, chosen, named)
    if asked.folder is None and not chosen.own:
        return keyed(Path("runs"), name, system_code(chosen.system, chosen.spec).state)
    now = datetime.now().strftime("%Y%m%d-%H%M%S-%f")
    place = asked.folder or Path("runs") / f"{name}-{now}"
    if chosen.own and (place / "manifest.json").exists():
        raise UserError(
            f"{place} holds a run, and whether it was of this same object cannot be told: give "
            "another folder, or put what builds the system into a file and name that."
        )
    return place


def _named(asked: AuditQuestion, study: str) -> list[str]:
    named = [study, asked.fault, Path(asked.library).stem]
    if asked.metric:
        named.append(f"{asked.metric}-{','.join(f'{each:g}' for each in asked.thresholds)}")
    if asked.rule != IN_FORCE:
        named.append(f"rule-{asked.rule}")
    if asked.stop_when is not None:
        small = "" if asked.margin_pp is None else f"-within-{asked.margin_pp:g}"
        named.append(f"until-{asked.stop_when}{small}")
    return named


def _name(asked: Running, chosen: Chosen, named: Sequence[str]) -> str:
    """Name the run folder after everything that makes it another study."""
    drawn = ",".join(map(str, asked.seeds))
    options = (f"{key}-{value}" for key, value in sorted(chosen.spec.options.items()))
    parts = [*named, *options]
    if asked.scenes is not None:
        parts.append(f"{asked.scenes}-scenes")
    if drawn != "0":
        parts.append(f"seeds-{drawn}")
    name = re.sub(r"[^A-Za-z0-9.+=,_-]+", "_", "-".join(parts)).strip("._")
    if len(name) > _LONGEST_NAME:
        name = f"{name[:_LONGEST_NAME]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
    return name
