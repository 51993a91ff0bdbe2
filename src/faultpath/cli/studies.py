"""Carrying a reproduction out on the terminal: progress, files, what came out."""

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from faultpath.cli.terminal import SafeConsole
from faultpath.errors import Stopped
from faultpath.evidence import EvidenceTable
from faultpath.execution import Interrupted, RunResult, Stopwatch, run_provenance
from faultpath.record import Reproduction, RunProvenance
from faultpath.report import Traces
from faultpath.report.reproduction import (
    ReproductionInput,
    ledger_markdown,
    ledger_view,
    reproduction_page,
)
from faultpath.store import traces_of, write_text
from faultpath.store.sealed import seal
from faultpath.studies import reversal
from faultpath.studies.flights import Flown, Leg, Pace, fly
from faultpath.studies.pages import table_4
from faultpath.studies.run import RESULTS, Plan, conclude, measure_all, save
from faultpath.tables import latex, markdown
from faultpath.tables.terminal import drawn

Show = Callable[[float, float, str], None]
"""Shows how much of what is done, and a remark."""


@dataclass(frozen=True)
class Done:
    """A reproduction and where its files are."""

    reproduction: Reproduction
    folder: Path


def carry_out(
    plan: Plan,
    folder: Path,
    workers: int,
    command: Sequence[str],
    quiet: bool = False,
    first: str = "",
    time_limit_s: float | None = None,
) -> Done:
    """Fly, measure, conclude and write the files of a plan.

    Raises `Stopped` on Ctrl-C, and `UserError` where the plan cannot be run. `quiet` leaves the
    standard output to the caller; `first` is a sentence to print before all others. `time_limit_s`
    is that of `run_study`.
    """
    console = SafeConsole(stderr=quiet)
    stopwatch = Stopwatch()
    if first:
        console.print(first, markup=False, soft_wrap=True)
    legs = plan.legs()
    if note := plan.substitution():
        console.print(note, markup=False, soft_wrap=True)
    try:
        flown = _fly(console, legs, folder, workers, time_limit_s)
        evidence = _measure(console, plan, folder, workers)
    except (Interrupted, KeyboardInterrupt):
        raise Stopped(
            f"interrupted; what is finished is kept in {folder}, and the same command resumes."
        ) from None
    results = plan.results(flown.outcomes, evidence)
    place = folder / plan.place
    found = conclude(plan, flown, results)
    result = save(place, flown, results, evidence, found)
    _tell_failures(console, result)
    backend = plan.system.backend
    files = seal(place, RESULTS)
    provenance = run_provenance(result, stopwatch, command, workers, backend, files)
    write_text(place / "provenance.json", provenance.model_dump_json(indent=2) + "\n", place)
    _write_pages(place, plan, found, provenance, flown)
    return Done(found, place)


def tell(plan: Plan, done: Done) -> None:
    """Print what came out: the ledger of the whole paper, or the tables of its pages."""
    console = SafeConsole()
    if plan.whole:
        console.print(ledger_view(done.reproduction.ledger))
    for table in () if plan.whole else done.reproduction.tables:
        console.print(drawn(table))
    page = done.folder / "reproduction.html"
    console.print(f"Report: {page}", markup=False, soft_wrap=True)


def _fly(
    console: SafeConsole,
    legs: Sequence[Leg],
    folder: Path,
    workers: int,
    time_limit_s: float | None,
) -> Flown:
    def notice(text: str) -> None:
        console.print(text, markup=False, soft_wrap=True)

    with _bar(console, "Flying", "trials") as show:

        def flying(now: Pace) -> None:
            show(now.trials_done, now.trials_total, f"{_left(now.seconds_left)}  {now.leg}")

        return fly(legs, folder, workers, flying, notice, time_limit_s)


def _measure(console: SafeConsole, plan: Plan, folder: Path, workers: int) -> EvidenceTable:
    if not plan.measurements():
        return EvidenceTable({})
    with _bar(console, "Measuring", "flights") as show:
        return measure_all(plan, folder, workers, lambda done, of: show(done, of, ""))


@contextmanager
def _bar(console: SafeConsole, what: str, unit: str) -> Generator[Show]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[count]}"),
        TimeElapsedColumn(),
        TextColumn("{task.fields[remark]}"),
    )
    with Progress(*columns, console=console) as bar:
        task = bar.add_task(what, total=None, count="", remark="")

        def show(done: float, total: float, remark: str) -> None:
            count = f"{done:.0f}/{total:.0f} {unit}"
            bar.update(task, completed=done, total=total, count=count, remark=remark)

        yield show


def _write_pages(
    place: Path, plan: Plan, found: Reproduction, provenance: RunProvenance, flown: Flown
) -> None:
    windy = next((i for i, leg in enumerate(flown.legs) if leg.setting == table_4.WINDY), None)
    asked = reversal.audited(flown.outcomes)
    flights = {(at.variant, at.path, at.seed, at.scene): t for at, t in traces_of(asked).items()}
    system = plan.system
    decision, variants = None, ()
    if windy is not None and reversal.whole(asked):
        leg = flown.legs[windy]
        decision = reversal.decision(asked, leg, flown.results[windy].deliveries)
        variants = reversal.wired(leg)
    source = ReproductionInput(
        reproduction=found,
        provenance=provenance,
        interface=system.interface,
        variants=variants,
        outcomes=asked,
        decision=decision,
        traces=Traces(flights, system.control_dt_s),
        plans={
            scene: drawn
            for scene in {*(row.outcome.scene for row in asked.rows), *_gallery(found)}
            if (drawn := system.floor_plan(scene)) is not None
        },
    )
    write_text(place / "reproduction.html", reproduction_page(source), place)
    write_text(place / "tables.tex", latex.document(found.tables), place)
    write_text(place / "tables.md", "\n\n".join(map(markdown.block, found.tables)) + "\n", place)
    write_text(place / "ledger.md", ledger_markdown(found.ledger), place)


def _gallery(found: Reproduction) -> list[str]:
    return [shown.scene for shown in found.gallery]


def _left(seconds: float | None) -> str:
    if seconds is None:
        return ""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d} left"


def _tell_failures(console: SafeConsole, result: RunResult) -> None:
    if result.failures:
        console.print(
            f"{len(result.failures)} trials failed and void their pairs.", style="bold red"
        )
    for failure in result.failures:
        line = f"  {failure.scene}: {failure.error} ({failure.details})"
        console.print(line, markup=False, soft_wrap=True)
