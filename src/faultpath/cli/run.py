"""Carrying an audit out on the terminal: progress, tables, files."""

import json
from collections.abc import Sequence
from pathlib import Path

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from faultpath.audit import Audit
from faultpath.cli.pages import MADE_FROM, RECORD, SYSTEM, save_pages
from faultpath.cli.terminal import SafeConsole
from faultpath.errors import Stopped
from faultpath.execution import (
    Failure,
    Interrupted,
    RunResult,
    Stopwatch,
    run_provenance,
    run_study,
)
from faultpath.execution import Progress as RunProgress
from faultpath.record import DecisionRecord
from faultpath.report import decision
from faultpath.store import write_text
from faultpath.store.sealed import seal
from faultpath.trials import System, system_shown

_SHOWN = 5
"""Different errors told one by one."""


def run_audit(
    system: System,
    audit: Audit,
    folder: Path,
    workers: int,
    command: Sequence[str],
    first: str = "",
    time_limit_s: float | None = None,
) -> int:
    """Run, decide and write the run folder; return the number of trials that failed.

    `first` is a sentence to print before all others.

    Raises `Stopped` on Ctrl-C, and `UserError` where the study cannot be run or nothing is left to
    compare.
    """
    console = SafeConsole()
    stopwatch = Stopwatch()
    if first:
        console.print(first, markup=False, soft_wrap=True)
    if system.backend:
        console.print(f"Computing with {system.backend}.", markup=False, soft_wrap=True)
    asked = audit.question
    shown = system_shown(system, (asked.baseline, asked.repair), audit.study.scenes)
    result = _run(console, system, audit, folder, workers, time_limit_s)
    _tell_failures(console, result, folder)
    record = audit.conclude(result.outcomes, result.deliveries)
    write_text(folder / RECORD, _json(record), folder)
    write_text(folder / SYSTEM, shown.model_dump_json(indent=1) + "\n", folder)
    files = seal(folder, MADE_FROM)
    provenance = run_provenance(result, stopwatch, command, workers, system.backend, files)
    write_text(folder / "provenance.json", provenance.model_dump_json(indent=2) + "\n", folder)
    save_pages(folder)
    console.print(decision(record))
    console.print(f"Report: {folder / 'report.html'}", markup=False, soft_wrap=True)
    return len(result.failures)


def _run(
    console: SafeConsole,
    system: System,
    audit: Audit,
    folder: Path,
    workers: int,
    time_limit_s: float | None,
) -> RunResult:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[trials]} trials"),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("Running", total=None, trials="", left="")

        def show(now: RunProgress) -> None:
            bar.update(
                task,
                total=now.trials_total,
                completed=now.trials_estimated,
                trials=f"{now.trials_done}/{now.trials_total}",
                left=left(now.seconds_left),
            )

        def notice(text: str) -> None:
            bar.console.print(text, markup=False, soft_wrap=True)

        try:
            return run_study(
                audit.study,
                folder,
                workers,
                show,
                notice=notice,
                system=system,
                time_limit_s=time_limit_s,
            )
        except Interrupted as stop:
            raise Stopped(
                f"interrupted with {stop.done} of {stop.total} blocks done and kept in {folder}; "
                "run the same command again to resume."
            ) from None


def left(seconds: float | None) -> str:
    """Say how long it will still take, where that is known."""
    if seconds is None:
        return ""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d} left"


def _json(record: DecisionRecord) -> str:
    return json.dumps(record.model_dump(mode="json"), indent=2) + "\n"


def _tell_failures(console: SafeConsole, result: RunResult, folder: Path) -> None:
    if not result.failures:
        return
    console.print(
        f"[bold red]{len(result.failures)} trials failed and void their pairs.[/bold red]"
    )
    alike: dict[str, list[Failure]] = {}
    for failure in result.failures:
        alike.setdefault(failure.error, []).append(failure)
    for error, (first, *more) in list(alike.items())[:_SHOWN]:
        rest = f" and {len(more)} more trials" if more else ""
        line = f"  {first.scene}{rest}: {' '.join(error.split())} ({first.details})"
        console.print(line, markup=False, soft_wrap=True)
    if len(alike) > _SHOWN:
        console.print(f"  and {len(alike) - _SHOWN} other errors, in {folder / 'failures'}")
