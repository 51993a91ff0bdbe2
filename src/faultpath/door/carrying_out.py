"""Carrying an audit out: run it, tell of it, and leave the files that its pages are made from."""

from pathlib import Path

from faultpath.door.display import Display, Now
from faultpath.door.saved import MADE_FROM, RECORD, SYSTEM, as_text, parsed
from faultpath.errors import Stopped, UserError
from faultpath.execution import (
    Failure,
    Interrupted,
    Progress,
    RunResult,
    Stopwatch,
    run_provenance,
    run_study,
)
from faultpath.planning import Audit
from faultpath.record import DecisionRecord, Question
from faultpath.record.decide import after_looks
from faultpath.statistics import RULES
from faultpath.store import write_text
from faultpath.store.manifest import kin
from faultpath.store.sealed import read_regular, seal
from faultpath.trials import System, system_shown
from faultpath.work import Executor

_SHOWN = 5
"""Different errors told one by one."""


def carry_out(
    system: System,
    audit: Audit,
    folder: Path,
    hands: Executor,
    told: Display,
    time_limit_s: float | None,
    memory_limit_gib: float | None = None,
    share: Path | None = None,
) -> None:
    """Run, decide and write what the run folder's pages are made from.

    Trials of the same arms that runs share in `share` are taken over.

    What was concluded before in the folder, or in another that shares these trials, is told in the
    record: see `after_looks`.

    Raises `Stopped` on Ctrl-C, and `UserError` where the study cannot be run or nothing is left to
    compare.
    """
    stopwatch = Stopwatch()
    if system.backend:
        told.say(f"Computing with {system.backend}.")
    asked = audit.question
    _check_rule(folder, asked)
    shown = system_shown(system, (asked.baseline, asked.repair), audit.study.scenes)
    result = _run(system, audit, folder, hands, told, time_limit_s, memory_limit_gib, share)
    tell_failures(told, result, folder)
    record = audit.conclude(result.outcomes, result.deliveries)
    places = [folder, *(kin(folder) if share is not None else ())]
    record = after_looks(record, (each for place in places for each in _concluded(place)))
    write_text(folder / RECORD, as_text(record), folder)
    write_text(folder / SYSTEM, shown.model_dump_json(indent=1) + "\n", folder)
    files = seal(folder, MADE_FROM)
    provenance = run_provenance(result, stopwatch, told.command, hands, system.backend, files)
    write_text(folder / "provenance.json", provenance.model_dump_json(indent=2) + "\n", folder)


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


def _run(
    system: System,
    audit: Audit,
    folder: Path,
    hands: Executor,
    told: Display,
    time_limit_s: float | None,
    memory_limit_gib: float | None,
    share: Path | None,
) -> RunResult:
    with told.progress("Running") as show:

        def note(now: Progress) -> None:
            count = f"{now.rows_done} of {now.rows_total} trials"
            show(Now(now.trials_estimated, now.trials_total, count, now.seconds_left))

        try:
            return run_study(
                audit.study,
                folder,
                progress=note,
                notice=told.say,
                system=system,
                executor=hands,
                time_limit_s=time_limit_s,
                memory_limit_gib=memory_limit_gib,
                share=share,
                stop=audit.stops,
            )
        except Interrupted as stop:
            raise Stopped(
                f"interrupted with {stop.done} of {stop.total} blocks done and kept in {folder}; "
                f"run the same {told.called} again to resume."
            ) from None


def tell_failures(told: Display, result: RunResult, folder: Path) -> None:
    """Tell of the trials that failed, the same error once."""
    if not result.failures:
        return
    told.say(f"{len(result.failures)} trials failed and void their pairs.", "bold red")
    alike: dict[str, list[Failure]] = {}
    for failure in result.failures:
        alike.setdefault(failure.error, []).append(failure)
    for error, (first, *more) in list(alike.items())[:_SHOWN]:
        rest = f" and {len(more)} more trials" if more else ""
        details = f" ({first.details})" if first.details else ""
        told.say(f"  {first.scene}{rest}: {' '.join(error.split())}{details}")
    if len(alike) > _SHOWN:
        told.say(f"  and {len(alike) - _SHOWN} other errors, in {folder / 'failures'}")
