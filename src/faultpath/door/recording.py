"""The signals of the scenes that a report begins with, recorded once an audit is finished.

An audit is whole without them: what goes wrong here is a finding, never an error of the audit.
"""

from collections.abc import Sequence
from pathlib import Path

from faultpath.door.display import Display, Now
from faultpath.door.replaying import Replayed, flown, fly_again, shown_first, write_signals
from faultpath.door.saved import RECORD, as_text, read_provenance, read_run
from faultpath.errors import UserError
from faultpath.planning import Audit
from faultpath.record import RunProvenance
from faultpath.record.wording import counted
from faultpath.report.inputs import ReportInput
from faultpath.store import write_text
from faultpath.store.folder import OUTCOMES, TRACES
from faultpath.store.sealed import seal
from faultpath.store.signals import SIGNALS
from faultpath.trials import Arm, System
from faultpath.work import Executor

_SCENES_FOR_ONE = 20
"""So many scenes of an audit, and one more is recorded: at most about a twentieth more flights."""


def provenance_of(folder: Path) -> RunProvenance | None:
    """Return how the run that a folder holds was made; `None` where it holds none that is sound."""
    try:
        return read_provenance(folder)
    except UserError:
        return None


def record_signals(
    system: System,
    audit: Audit,
    folder: Path,
    hands: Executor,
    told: Display,
    before: RunProvenance | None,
    time_limit_s: float | None = None,
    memory_limit_gib: float | None = None,
) -> None:
    """Fly the scenes that the report begins with once more, and keep what is heard in them.

    `before` is the provenance of the run that the folder held, whose signals stay where its trials
    are these.
    """
    if before is not None:
        _bring_back(folder, before)
    held, _ = read_run(folder)
    few = shown_first(held)[: 1 + held.record.scenes // _SCENES_FOR_ONE]
    named = {path.name for path in held.record.paths}
    wanted = [
        at
        for at in flown(held)
        if (at.scene, at.seed) in few and at.path in named and at not in held.signals
    ]
    if not wanted:
        return
    try:
        with told.progress("Recording signals") as show:

            def note(arm: Arm, done: int, total: int) -> None:
                show(Now(done, total, f"{done} of {total} arms, {counted(len(few), 'scene')}"))

            found = fly_again(
                held, audit.study, system, hands, wanted, note, time_limit_s, memory_limit_gib
            )
    except UserError as error:
        _tell(folder, held, told, f"No signals were recorded: {error}")
        return
    except KeyboardInterrupt:
        told.say(f"No signals were recorded; run the same {told.called} again to have them.")
        return
    if any(each.signals for each in found):
        write_signals(folder, held, found)
    if unlike := [each for each in found if each.differs]:
        _tell(folder, read_run(folder)[0], told, _unlike(found, unlike))


def _bring_back(folder: Path, before: RunProvenance) -> None:
    """Keep the signals of the run that the folder held, where it flew these very trials."""
    now = read_provenance(folder)
    same = now.system_fingerprint == before.system_fingerprint and all(
        now.files[name] == before.files.get(name) for name in (OUTCOMES, TRACES)
    )
    if not same or SIGNALS not in before.files or not (folder / SIGNALS).is_file():
        return
    if seal(folder, [SIGNALS])[SIGNALS] == before.files[SIGNALS]:
        _write(folder, now, {SIGNALS: before.files[SIGNALS]})


def _unlike(found: Sequence[Replayed], unlike: Sequence[Replayed]) -> str:
    at, differs = unlike[0].address, unlike[0].differs
    return (
        f"Signals of {len(unlike)} of {counted(len(found), 'trial')} were not recorded: flown "
        f"again, it came out otherwise: {at.variant}, {at.path}, {at.scene}: {differs}."
    )


def _tell(folder: Path, held: ReportInput, told: Display, finding: str) -> None:
    """Add a finding to the record of a finished audit, and tell of it."""
    told.say(finding)
    record = held.record.model_copy(update={"findings": (*held.record.findings, finding)})
    write_text(folder / RECORD, as_text(record), folder)
    _write(folder, held.provenance, seal(folder, [RECORD]))


def _write(folder: Path, provenance: RunProvenance, files: dict[str, str]) -> None:
    sealed = provenance.model_copy(update={"files": {**provenance.files, **files}})
    write_text(folder / "provenance.json", sealed.model_dump_json(indent=2) + "\n", folder)
