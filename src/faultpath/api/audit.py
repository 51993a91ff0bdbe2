"""`faultpath.audit`, `map` and `scan`: run the trials of a question, conclude, write the folder."""

import os
from collections.abc import Sequence
from contextlib import suppress
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from faultpath.analyses.analysis import Analysis
from faultpath.analyses.audit import AuditAnalysis, audit_analysis
from faultpath.analyses.decide import with_earlier_analyses
from faultpath.analyses.map.analysis import map_analysis
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.analysis import ranked_sources, scan_analysis
from faultpath.analyses.scan.sources import Ranking
from faultpath.api.display import Display
from faultpath.api.folders import (
    MADE_FROM,
    RECORD,
    SYSTEM,
    as_text,
    parsed,
    read_provenance,
)
from faultpath.api.job import Job, begin, job_of, with_question_signature
from faultpath.api.replaying import Replayed, outcomes_at, run_again, shown_first
from faultpath.api.runs import MapRun, Run, ScanRun
from faultpath.core.errors import UserError
from faultpath.core.files.atomic import is_run, write_file, write_text
from faultpath.core.files.opening import read_regular
from faultpath.core.files.parquet import Unreadable
from faultpath.core.text import counted
from faultpath.faults import FaultText
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences.findings import describe
from faultpath.run.execution.runner import RunResult
from faultpath.run.findings import Finding, Unrecorded, Unrepeated
from faultpath.run.provenance import seal
from faultpath.run.question import AuditCall, MapCall, ScanCall, ask
from faultpath.run.shown import system_shown
from faultpath.run.store.folder import OUTCOMES
from faultpath.run.store.signals import (
    SIGNALS,
    Signal,
    Signals,
    decode_signals,
    encode_signals,
)
from faultpath.run.store.tables import TrialAddress
from faultpath.run.work.executor import Progress
from faultpath.system.system import System

_Finished = TypeVar("_Finished", MapRun, ScanRun)

_SCENES_FOR_ONE = 20
"""So many scenes of an audit, and one more is recorded: at most about a twentieth more trials."""


@with_question_signature(AuditCall)
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
    question, chosen, library, display = begin("audit", AuditCall, system, arguments, progress)
    analysis = audit_analysis(chosen.system, chosen.spec, question, library)
    variants = question.baseline, question.repair
    with job_of(question, chosen, analysis, display) as job:
        shown = system_shown(chosen.system, variants, analysis.plan.scenes)
        _, result = job.trials(analysis)
        record = with_stored(job.folder, analysis.conclude(result.trials, result.deliveries))
        recorded = _kept_signals(job.folder, result)
        if question.signals:
            replays, finding = _run_first_scenes(analysis, job, record, result, recorded)
            recorded |= {replay.address: replay.signals for replay in replays if replay.signals}
            finding = finding or _unrepeated(replays)
            if finding:
                display.say(describe(finding))
                findings = (*result.deliveries.findings, finding)
                deliveries = result.deliveries.model_copy(update={"findings": findings})
                record = with_stored(job.folder, analysis.conclude(result.trials, deliveries))
        recorded = dict(sorted(recorded.items()))
        write_text(job.folder / RECORD, as_text(record), job.folder)
        write_text(job.folder / SYSTEM, as_text(shown), job.folder)
        if recorded:
            write_file(job.folder / SIGNALS, encode_signals(recorded), job.folder)
        files = (*MADE_FROM, SIGNALS) if recorded else MADE_FROM
        provenance = job.finish(result, files, chosen.system.backend)
    run = Run(job.folder, ReportInput(record, provenance, shown, result.trials, recorded))
    run.report()
    return run


@with_question_signature(AuditCall)
def audits(
    system: str | PathLike[str] | System, *, progress: bool | Display = True, **arguments: Any
) -> tuple[Run, ...]:
    """Audit a repair under each size of a fault.

    Each size is an audit with a result of its own, which holds within a size; `compare` tests all
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
    if isinstance(fault, str):
        fault = FaultText.read(fault)
    if not isinstance(fault, FaultText) or len(fault.sizes) < 2:
        return (audit(system, progress=progress, **{**arguments, "fault": fault}),)
    sizes = fault.each()
    by_flag = isinstance(progress, Display) and progress.is_command
    folder = ask(AuditCall, {**arguments, "fault": sizes[0]}, by_flag).folder
    if folder is not None and is_run(folder):
        raise UserError(f"{folder} holds a run: give another folder for the audits of each size.")
    runs: list[Run] = []
    for number, size in enumerate(sizes, 1):
        place = None if folder is None else folder / f"size-{number}"
        sized = {**arguments, "fault": size, "folder": place}
        runs.append(audit(system, progress=progress, **sized))
    return tuple(runs)


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
    question, chosen, library, display = begin("map", MapCall, system, arguments, progress)
    analysis = map_analysis(chosen.system, chosen.spec, question, library)
    with job_of(question, chosen, analysis, display) as job:
        run = _concluded(MapRun, analysis, job)
    run.report()
    return run


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
    question, chosen, library, display = begin("scan", ScanCall, system, arguments, progress)
    if not question.trials:
        return ranked_sources(chosen.system, question, library)
    analysis = scan_analysis(chosen.system, chosen.spec, question, library)
    with job_of(question, chosen, analysis, display) as job:
        run = _concluded(ScanRun, analysis, job)
    run.report()
    return run


def _concluded(kind: type[_Finished], analysis: Analysis[Any], job: Job) -> _Finished:
    """Run the rounds of an analysis, conclude, and write its result."""
    items, result = job.trials(analysis)
    record = analysis.conclude(result.trials, result.deliveries, items)
    write_text(job.folder / kind.files[0], as_text(record), job.folder)
    return kind(job.folder, record, job.finish(result, kind.files, analysis.system.backend))


def with_stored(folder: Path, record: AuditResult) -> AuditResult:
    """Return a record with the one that the folder holds of the same trials, if any, among its
    earlier analyses.

    `UserError` for a stored record that cannot be read: taken for none, earlier analyses would be
    lost.
    """
    if not os.path.lexists(folder / RECORD):
        return record
    before = parsed(read_regular(folder / RECORD), folder / RECORD, AuditResult)
    same_trials = before.facts.library_hash == record.facts.library_hash
    return with_earlier_analyses(record, (before,)) if same_trials else record


def _kept_signals(folder: Path, result: RunResult) -> dict[TrialAddress, tuple[Signal, ...]]:
    """Return the signals that the folder holds of these very trials; none where they changed."""
    with suppress(OSError, UserError, Unreadable):
        earlier = read_provenance(folder)
        here = {OUTCOMES: result.outcomes_sha256, **seal(folder, [SIGNALS])}
        same_code = earlier.code.system_fingerprint == result.system_fingerprint
        if same_code and here.items() <= earlier.files.items():
            return decode_signals(read_regular(folder / SIGNALS))
    return {}


def _run_first_scenes(
    audit: AuditAnalysis,
    job: Job,
    record: AuditResult,
    result: RunResult,
    recorded: Signals,
) -> tuple[Sequence[Replayed], Finding | None]:
    """Run the scenes that the report begins with again, where they are not `recorded`; return
    their trials, and a finding where they could not be run.

    What goes wrong here is a finding, never an error of the audit.
    """
    few = shown_first(record, result.trials, recorded)[: 1 + record.scenes // _SCENES_FOR_ONE]
    named = {condition.name for condition in record.conditions}
    before = outcomes_at(result.trials)
    missing = [
        at
        for at in before
        if (at.scene, at.seed) in few and at.condition in named and at not in recorded
    ]
    if not missing:
        return (), None
    try:
        with job.display.progress("Recording signals") as show:

            def note(treatment: object, done: int, total: int) -> None:
                count = f"{done} of {total} batches of {counted(len(few), 'scene')}"
                show(Progress(done, total, count))

            return run_again(before, audit.plan, audit.system, job.executor, missing, note), None
    except UserError as error:
        return (), Unrecorded(error=str(error))
    except KeyboardInterrupt:
        called = job.display.called
        job.display.say(f"No signals were recorded; run the same {called} again to have them.")
        return (), None


def _unrepeated(replays: Sequence[Replayed]) -> Unrepeated | None:
    """Return a finding where trials came out otherwise when they were run again."""
    unlike = [(replay.address, replay.deviation) for replay in replays if replay.deviation]
    if not unlike:
        return None
    at, deviation = unlike[0]
    return Unrepeated(
        trials=len(unlike),
        of=len(replays),
        variant=at.variant,
        condition=at.condition,
        scene=at.scene,
        deviation=deviation,
    )
