"""Carrying an audit out: run it, decide, record signals, and write what its pages are made from."""

from collections.abc import Mapping
from pathlib import Path

from faultpath.api.job import Job
from faultpath.api.replaying import Replayed, as_flown, fly_again, shown_first
from faultpath.api.saved import MADE_FROM, RECORD, SYSTEM, as_text, parsed, read_provenance
from faultpath.core.errors import UserError
from faultpath.decisions import DecisionRecord, Question, RunProvenance
from faultpath.decisions.decide import after_looks
from faultpath.decisions.phrases import counted
from faultpath.decisions.planning import Audit
from faultpath.report.inputs import ReportInput, Traces
from faultpath.statistics import RULES
from faultpath.trials import System, system_shown
from faultpath.trials.execution import RunResult
from faultpath.trials.store import TrialAddress, write_text
from faultpath.trials.store.atomic import write_file
from faultpath.trials.store.parquet import Unreadable
from faultpath.trials.store.sealed import read_regular, seal
from faultpath.trials.store.signals import SIGNALS, Signal, decode_signals, encode_signals
from faultpath.trials.work import Progress

_SCENES_FOR_ONE = 20
"""So many scenes of an audit, and one more is recorded: at most about a twentieth more trials."""


def carry_out(system: System, audit: Audit, job: Job, signals: bool = True) -> ReportInput:
    """Run, decide and write what the run folder's pages are made from; return that.

    What was concluded before in the folder is told in the record: see `after_looks`. With
    `signals`, the scenes that the report begins with run once more and keep what is read in them;
    what goes wrong there is a finding, never an error of the audit.

    Raises `Stopped` on Ctrl-C, and `UserError` where the study cannot be run or nothing is left to
    compare.
    """
    folder, display, asked = job.folder, job.display, audit.question
    if system.backend:
        display.say(f"Computing with {system.backend}.")
    _check_rule(folder, asked)
    before = provenance_of(folder)
    shown = system_shown(system, (asked.baseline, asked.repair), audit.study.scenes)
    with display.progress("Running") as show:
        result = job.run(audit.study, system, show, stop=audit.stops)
    record = audit.conclude(result.outcomes, result.deliveries)
    record = after_looks(record, _concluded(folder))
    traces = Traces(result.traces, system.control_dt_s)
    held = _kept(folder, before, result)
    if signals:
        held, findings = _recorded(system, audit, job, record, result, traces, held)
        record = record.model_copy(update={"findings": (*record.findings, *findings)})
    write_text(folder / RECORD, as_text(record), folder)
    write_text(folder / SYSTEM, shown.model_dump_json(indent=1) + "\n", folder)
    if held:
        write_file(folder / SIGNALS, encode_signals(dict(sorted(held.items()))), folder)
    provenance = job.finish(result, system, (*MADE_FROM, *([SIGNALS] if held else ())))
    return ReportInput(
        record=record,
        provenance=provenance,
        interface=shown.interface,
        variants=shown.variants,
        outcomes=result.outcomes,
        traces=traces,
        plans=shown.plans,
        signals=held,
    )


def provenance_of(folder: Path) -> RunProvenance | None:
    """Return how the run that a folder holds was made; `None` where it holds none that is sound."""
    try:
        return read_provenance(folder)
    except UserError:
        return None


def _concluded(folder: Path) -> tuple[DecisionRecord, ...]:
    place = folder / RECORD
    try:
        return (parsed(read_regular(place), place, DecisionRecord),)
    except UserError:  # nothing was decided there, or it is damaged and made anew
        return ()


def _check_rule(folder: Path, asked: Question) -> None:
    """Raise `UserError` where a run was decided by another rule: its verdict is not redone."""
    for before in (each.question for each in _concluded(folder)):
        if not (before.stop or asked.stop) and before.rule != asked.rule:
            raise UserError(
                f"{folder} was decided by the rule '{before.rule}' ({RULES[before.rule].words}), "
                f"and a verdict is not redone by another: give --rule {before.rule}, or another "
                "folder."
            )


_Signals = Mapping[TrialAddress, tuple[Signal, ...]]


def _kept(folder: Path, before: RunProvenance | None, result: RunResult) -> _Signals:
    """Return the signals of the run that the folder held, where it ran these very trials."""
    same = before is not None and (before.system_fingerprint, before.outcomes_sha256) == (
        result.system_fingerprint,
        result.outcomes_sha256,
    )
    if before is None or not same or SIGNALS not in before.files:
        return {}
    try:
        if seal(folder, [SIGNALS])[SIGNALS] == before.files[SIGNALS]:
            return decode_signals(read_regular(folder / SIGNALS))
    except (OSError, UserError, Unreadable):
        pass
    return {}


def _recorded(
    system: System,
    audit: Audit,
    job: Job,
    record: DecisionRecord,
    result: RunResult,
    traces: Traces,
    held: _Signals,
) -> tuple[_Signals, tuple[str, ...]]:
    """Run the scenes that the report begins with once more; return signals and findings."""
    display = job.display
    few = shown_first(record, result.outcomes, traces)[: 1 + record.scenes // _SCENES_FOR_ONE]
    named = {path.name for path in record.paths}
    before = as_flown(result.outcomes, traces)
    wanted = [
        at for at in before if (at.scene, at.seed) in few and at.path in named and at not in held
    ]
    if not wanted:
        return held, ()
    try:
        with display.progress("Recording signals") as show:

            def note(arm: object, done: int, total: int) -> None:
                count = f"{done} of {total} arms, {counted(len(few), 'scene')}"
                show(Progress(done, total, count))

            library_hash = audit.question.library_hash
            found = fly_again(
                before,
                audit.study,
                library_hash,
                system,
                job.executor,
                wanted,
                note,
                job.time_limit_s,
            )
    except UserError as error:
        said = f"No signals were recorded: {error}"
        display.say(said)
        return held, (said,)
    except KeyboardInterrupt:
        display.say(f"No signals were recorded; run the same {display.called} again to have them.")
        return held, ()
    held = {**held, **{each.address: each.signals for each in found if each.signals}}
    if unlike := [each for each in found if each.differs]:
        said = _unlike(len(found), unlike)
        display.say(said)
        return held, (said,)
    return held, ()


def _unlike(count: int, unlike: list[Replayed]) -> str:
    at, differs = unlike[0].address, unlike[0].differs
    return (
        f"Signals of {len(unlike)} of {counted(count, 'trial')} were not recorded: run again, it "
        f"came out otherwise: {at.variant}, {at.path}, {at.scene}: {differs}."
    )
