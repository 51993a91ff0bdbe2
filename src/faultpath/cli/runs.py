"""`faultpath demo`, `audit`, `judge`, `map`, `scan` and `report`: verbs of run folders."""

import hashlib
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.gates import FailIf, Gate, Junit, Summary
from faultpath.cli.options import FOUND, Json, SystemName, display
from faultpath.cli.options import path as as_path
from faultpath.core.errors import UserError
from faultpath.core.text import one_line
from faultpath.run.question import AuditCall, MapCall, ScanCall
from faultpath.run.received.question import JudgeQuestion

if TYPE_CHECKING:
    from rich.console import Console

    from faultpath.api.runs import MapRun, Run, ScanRun
    from faultpath.report.tables import Table

Details = Annotated[
    bool,
    typer.Option(
        "--details", help="Print every sentence of the result too, and what would change it."
    ),
]

_TOY = "toy.py"
_STORY = (
    "A cart: its controller and its observer read one estimate of the motor's gain. The fault: the "
    "estimate is 0.6 times the true gain. In `calibrated` the observer uses it, in `blind` the "
    "number on the nameplate.\n"
)


def demo(
    out: Annotated[
        Path | None,
        typer.Option(parser=as_path, help="Run folder; default one in runs, so it resumes."),
    ] = None,
) -> int:
    """Audit the toy that ships with faultpath: a cart whose controller and observer share one wrong
    gain, and a repair that wins where only the observer gets it."""
    import faultpath.system
    from faultpath.api.audit import audit
    from faultpath.api.display import SafeConsole
    from faultpath.report.terminal import decision

    toy = Path(faultpath.system.__file__).with_name(_TOY)
    if not toy.is_file():  # in a checkout, which a wheel takes it from
        toy = Path(__file__).resolve().parents[3] / "examples" / _TOY
    console = SafeConsole()
    console.print(_STORY, markup=False)
    variants = {"baseline": "calibrated", "repair": "blind", "fault": "gain:scale=0.6"}
    run = audit(f"{toy}:create", **variants, library="carts", folder=out, progress=display())
    console.print(decision(run.record))
    _print_place(console, run)
    console.print(f"The system: {toy}. Next, one of your own: faultpath init mine", markup=False)
    return FOUND if run.failed else 0


@takes(AuditCall)
def audit(
    system: SystemName,
    details: Details = False,
    as_json: Json = False,
    fail_if: FailIf = None,
    junit: Junit = None,
    summary: Summary = None,
    **arguments: Any,
) -> int:
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault."""
    gate = Gate.of(fail_if, junit, summary)
    if sys.stderr.isatty():  # what builds a system may load for seconds, with nothing else to see
        variants = f"{one_line(arguments['repair'])} with {one_line(arguments['baseline'])}"
        typer.echo(f"Building {one_line(system)}, to compare {variants}.", err=True)

    from faultpath.api.audit import audits
    from faultpath.api.display import SafeConsole
    from faultpath.api.runs import compare
    from faultpath.report.comparison import shown

    runs = audits(system, **arguments, progress=display())
    status = _print(runs, as_json, gate, len(runs) == 1 or details, details)
    if len(runs) > 1:
        compared, first, folder = compare(runs), runs[0].folder, arguments.get("folder")
        names = "/".join(run.folder.name for run in runs)
        digest = hashlib.sha256(names.encode()).hexdigest()[:8]
        beside = first.with_name(f"{first.name}+{len(runs) - 1}-sizes-{digest}.html")
        page = compared.report(folder / "sweep.html" if folder else beside)
        console = SafeConsole(stderr=as_json)
        console.print(shown(compared.runs))
        console.print(f"Page: {page}", markup=False, soft_wrap=True)
    return status


@takes(JudgeQuestion)
def judge(
    results: Annotated[
        list[str],
        typer.Argument(
            help="Files or folders: CSV, Parquet, JSON lines, LeRobot's eval_info.json, logs of "
            "Inspect, samples of lm-eval. VERSION=FILE or VERSION@CONDITION=FILE says what a file "
            "does not."
        ),
    ],
    details: Details = False,
    as_json: Json = False,
    fail_if: FailIf = None,
    junit: Junit = None,
    summary: Summary = None,
    **arguments: Any,
) -> int:
    """Compare two versions in trials that other tools ran, with the tests, the result and the
    report of an audit.

    Trials are paired by task, scene, seed and condition; what cannot be paired is refused, and a
    missing pair is named with what it could change."""
    from faultpath.api.judging import judge

    gate = Gate.of(fail_if, junit, summary)
    run = judge(results, **arguments, progress=display())
    return _print((run,), as_json, gate, True, details)


@takes(MapCall)
def reversal_map(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error reverses that."""
    from faultpath.api.audit import map
    from faultpath.report.map import tables

    run = map(system, **arguments, progress=display())
    return _print_conclusion(run, tables(run.record), as_json)


@takes(ScanCall)
def scan(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Find which errors of a system's inputs cancel: each alone costs success, and both together
    less than either, so that correcting one of them alone does not help."""
    from faultpath.analyses.scan.sources import Ranking
    from faultpath.api.audit import scan
    from faultpath.api.display import SafeConsole
    from faultpath.report.scan import ranking_table, tables
    from faultpath.report.terminal import Parted

    run = scan(system, **arguments, progress=display())
    if isinstance(run, Ranking):
        if as_json:
            typer.echo(run.model_dump_json(indent=1))
            return 0
        table, console = ranking_table(run), SafeConsole()
        console.print(Parted(table))
        for note in table.notes:
            console.print(note, markup=False)
        return 0
    return _print_conclusion(run, tables(run.record), as_json)


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(
            parser=as_path,
            help="One finished run, to write its pages again; several audits, to compare them.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(parser=as_path, help="Write the comparison to this .html file too."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Write the pages of a finished run again, or compare several audits; runs no code from any
    of them."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.runs import compare, open_run
    from faultpath.report.comparison import shown

    if len(folders) == 1:
        if out is not None:
            raise UserError(
                "--out takes the page of a comparison: give two or more finished audits."
            )
        if as_json:
            raise UserError("--json prints a comparison: the result of one run is its record.json.")
        for written in open_run(folders[0]).report():
            typer.echo(written)
        return

    compared = compare(folders)
    page = None if out is None else compared.report(out)
    if as_json:
        typer.echo(json.dumps(compared.as_json(), indent=1))
        return
    console = SafeConsole()
    console.print(shown(compared.runs))
    if page is not None:
        console.print(f"Page: {page}", markup=False, soft_wrap=True)


def _print(runs: "Sequence[Run]", as_json: bool, gate: Gate, sentences: bool, details: bool) -> int:
    """Print what was decided in each run, and its folder and record as JSON; return the status."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.runs import compare, in_json
    from faultpath.report.terminal import decision

    if as_json:
        several = len(runs) > 1  # of several sizes with what stands over all of them
        alone = [in_json(run.folder, run.record) for run in runs]
        entries = compare(runs).as_json()["runs"] if several else alone
        typer.echo(json.dumps(entries, indent=1))
    console = SafeConsole(stderr=as_json)
    for run in runs if sentences else ():
        if len(runs) > 1:
            console.print(f"\nFault {run.record.question.fault}", markup=False)
        console.print(decision(run.record, details))
        _print_place(console, run)
    return gate.end(runs, console.print)


def _print_conclusion(run: "MapRun | ScanRun", tables: "Sequence[Table]", as_json: bool) -> int:
    """Print what a map or a scan found, or that as JSON; return the exit status."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.runs import in_json
    from faultpath.report.terminal import conclusion

    if as_json:
        typer.echo(json.dumps(in_json(run.folder, run.record), indent=1))
    else:
        console = SafeConsole()
        console.print(conclusion(run.record, tables))
        for command in run.words.commands or ():
            console.print(f"Next: {command}", markup=False, soft_wrap=True)
        _print_place(console, run)
    return FOUND if run.record.failed else 0


def _print_place(console: "Console", run: "Run | MapRun | ScanRun") -> None:
    console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
