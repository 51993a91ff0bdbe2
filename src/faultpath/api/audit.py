"""`faultpath.audit`: run the arms of one question, decide, and write the run folder."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import Any

from faultpath.api.display import Display
from faultpath.api.folders import (
    MADE_FROM,
    RECORD,
    SYSTEM,
    as_text,
    parsed,
    read_provenance,
    read_run,
)
from faultpath.api.job import Job, asks, begin
from faultpath.api.replaying import outcomes_at, run_again, shown_first
from faultpath.api.runs import Run
from faultpath.api.systems import Chosen, executor_of
from faultpath.core.errors import UserError
from faultpath.core.files.parquet import Unreadable
from faultpath.decisions.decide import after_looks
from faultpath.decisions.fault_groups import JOINED
from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.planning import Audit, plan_audit
from faultpath.decisions.sentences.wording import counted
from faultpath.faults import each_size
from faultpath.report.inputs import Traces
from faultpath.trials import System, system_shown
from faultpath.trials.code import system_code
from faultpath.trials.execution.runner import RunResult
from faultpath.trials.question import AuditQuestion, Running
from faultpath.trials.sensitivity_question import SensitivityQuestion
from faultpath.trials.store.atomic import write_file, write_text
from faultpath.trials.store.folder import keyed, read_regular, seal
from faultpath.trials.store.signals import SIGNALS, Signal, decode_signals, encode_signals
from faultpath.trials.store.tables import TrialAddress
from faultpath.trials.work.executor import Progress

_LONGEST_NAME = 180
"""Longest name of a run folder; file systems take 255 bytes."""
_SCENES_FOR_ONE = 20
"""So many scenes of an audit, and one more is recorded: at most about a twentieth more trials."""

_Signals = Mapping[TrialAddress, tuple[Signal, ...]]


@asks(AuditQuestion)
def audit(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> Run:
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault.

    Args:
        system: `quadrotor`, `module:attribute`, `file.py:attribute`, a file in which `create`
            builds the system, or a `System`. One that `load_system` gave is built again from its
            name and options, in worker processes too. Any other object runs as it is, in this
            process, and its trials are never taken for those of another call.
        progress: Whether to show progress and notices, in a notebook's cell or on the standard
            error; otherwise notices go to the log `faultpath`.
        **arguments: ...

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    question, chosen, library, display = begin("audit", AuditQuestion, system, arguments, progress)
    laid = plan_audit(chosen.system, chosen.spec, question, library)
    named = [laid.study.name, question.fault, Path(question.library).stem]
    if question.stop_when is not None:
        small = "" if question.margin_pp is None else f"-within-{question.margin_pp:g}"
        named.append(f"until-{question.stop_when}{small}")
    place = run_folder(question, chosen, named)
    with executor_of(chosen.system, chosen.workers, chosen.executor) as executor:
        job = Job(place, executor, display, {"time_limit_s": question.time_limit_s})
        carry_out(chosen.system, laid, job, question.signals)
    run = Run(place, *read_run(place))
    run.report()
    return run


@asks(AuditQuestion)
def audits(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> tuple[Run, ...]:
    """Audit a repair under each size of a fault.

    Each size is an audit with a record of its own, which holds within a size; `compare` decides all
    of them as one family.

    Args:
        system: As for `audit`.
        progress: As for `audit`.
        **arguments: ...

    The fault has its sizes one after the other, `gain:scale=0.8,0.9,1.1`, or in a range,
    `calibration=-0.2..0.2/9`: nine sizes at equal distances, both ends among them. In `folder` each
    size gets a folder of its own.

    Raises:
        UserError: As `audit`, and for a size given twice.
    """
    fault = arguments.get("fault")
    several = isinstance(fault, str) and JOINED.strip() not in fault
    texts = each_size(arguments["fault"]) if several else ()
    if len(texts) < 2:
        return (audit(system, progress=progress, **arguments),)
    folder = arguments.pop("folder", None)
    runs: list[Run] = []
    for number, text in enumerate(texts, 1):
        place = None if folder is None else Path(folder) / f"size-{number}"
        runs.append(
            audit(system, progress=progress, **{**arguments, "fault": text, "folder": place})
        )
    return tuple(runs)


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


def carry_out(system: System, audit: Audit, job: Job, signals: bool) -> None:
    """Run, decide and write what the run folder's pages are made from.

    What was concluded before in the folder stands in the record: see `after_looks`. Raises
    `Stopped` on Ctrl-C, and `UserError` where the study cannot be run or nothing can be compared.
    """
    folder = job.folder
    if system.backend:
        job.display.say(f"Computing with {system.backend}.")
    earlier, before = None, concluded_before(folder)
    if before is not None:
        audit = replace(audit, question=audit.question.by_the_rule_of(before.question))
    question = audit.question
    with suppress(UserError):  # nothing sound stands there: it is made anew
        earlier = read_provenance(folder)
    shown = system_shown(system, (question.baseline, question.repair), audit.study.scenes)
    with job.display.progress("Running") as show:
        result = job.run(audit.study, system, show, stop=audit.stops)
    record = audit.conclude(result.outcomes, result.deliveries)
    record = after_looks(record, () if before is None else (before,))
    recorded: _Signals = {}
    if earlier is not None and SIGNALS in earlier.files:
        same = (earlier.system_fingerprint, earlier.outcomes_sha256)
        with suppress(OSError, UserError, Unreadable):
            if same == (result.system_fingerprint, result.outcomes_sha256) and (
                seal(folder, [SIGNALS])[SIGNALS] == earlier.files[SIGNALS]
            ):  # of these very trials
                recorded = decode_signals(read_regular(folder / SIGNALS))
    if signals:
        recorded, finding = _recorded(system, audit, job, record, result, recorded)
        if finding:
            job.display.say(finding)
            record = record.model_copy(update={"findings": (*record.findings, finding)})
    write_text(folder / RECORD, as_text(record), folder)
    write_text(folder / SYSTEM, shown.model_dump_json(indent=1) + "\n", folder)
    if recorded:
        write_file(folder / SIGNALS, encode_signals(dict(sorted(recorded.items()))), folder)
    job.finish(result, system, (*MADE_FROM, *([SIGNALS] if recorded else ())))


def concluded_before(folder: Path) -> DecisionRecord | None:
    """Return the record that a folder holds, if any."""
    try:
        return parsed(read_regular(folder / RECORD), folder / RECORD, DecisionRecord)
    except UserError:
        return None


def _recorded(
    system: System,
    audit: Audit,
    job: Job,
    record: DecisionRecord,
    result: RunResult,
    recorded: _Signals,
) -> tuple[_Signals, str]:
    """Run the scenes that the report begins with once more; return signals and a finding.

    What goes wrong here is a finding, never an error of the audit.
    """
    traces = Traces(result.traces, system.control_dt_s)
    few = shown_first(record, result.outcomes)[: 1 + record.scenes // _SCENES_FOR_ONE]
    named = {path.name for path in record.paths}
    before = outcomes_at(result.outcomes, traces)
    missing = [
        at
        for at in before
        if (at.scene, at.seed) in few and at.path in named and at not in recorded
    ]
    if not missing:
        return recorded, ""
    try:
        with job.display.progress("Recording signals") as show:

            def note(arm: object, done: int, total: int) -> None:
                count = f"{done} of {total} arms, {counted(len(few), 'scene')}"
                show(Progress(done, total, count))

            replays = run_again(before, audit.study, system, job.executor, missing, note)
    except UserError as error:
        return recorded, f"No signals were recorded: {error}"
    except KeyboardInterrupt:
        called = job.display.called
        job.display.say(f"No signals were recorded; run the same {called} again to have them.")
        return recorded, ""
    recorded = {
        **recorded,
        **{replay.address: replay.signals for replay in replays if replay.signals},
    }
    unlike = [replay for replay in replays if replay.differs]
    if not unlike:
        return recorded, ""
    at, differs = unlike[0].address, unlike[0].differs
    return recorded, (
        f"Signals of {len(unlike)} of {counted(len(replays), 'trial')} were not recorded: run "
        f"again, it came out otherwise: {at.variant}, {at.path}, {at.scene}: {differs}."
    )
