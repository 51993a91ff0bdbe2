"""`faultpath plan`, `audit` and `map`: the verbs that compare a repair with a baseline."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FOUND, Json, SystemName, display, path
from faultpath.core.text import one_line
from faultpath.trials.question import AuditQuestion, MapQuestion, PlanQuestion, Question, Running

if TYPE_CHECKING:
    from faultpath.api.display import SafeConsole
    from faultpath.api.runs import Run


@takes(PlanQuestion)
def plan(
    system: SystemName,
    out: Annotated[Path, typer.Option(parser=path, help="Study file to write.")] = Path(
        "study.yaml"
    ),
    as_json: Json = False,
    **given: Any,
) -> None:
    """Rank the uncertain sources, propose the audits of a repair with their trials, and
    write them as a study file for `faultpath audit --study`."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.planned import check_new, plan

    check_new(out)
    found = plan(system, **given, progress=display())
    written = found.write(out)

    from faultpath.decisions.tables.terminal import drawn
    from faultpath.report.plan import by_audit, by_rank

    if as_json:
        typer.echo(found.plan.model_dump_json(indent=2))
        return
    console = SafeConsole()
    for table in (by_rank(found.plan), by_audit(found.plan)):
        console.print(drawn(table))
        for note in table.notes:
            console.print(note, markup=False)
        console.print()
    for sentence in found.sentences:
        console.print(sentence, markup=False)
    console.print(f"Written: {written}", markup=False, soft_wrap=True)


@takes(AuditQuestion)
def audit(
    system: SystemName,
    details: Annotated[
        bool,
        typer.Option(
            "--details", help="Print every sentence of the record too, and what would change it."
        ),
    ] = False,
    as_json: Json = False,
    **given: Any,
) -> int:
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault.

    `faultpath audit --study FILE` carries out what `faultpath plan` wrote instead."""
    # What builds a system may load for seconds; until then this is all that there is to see.
    arms = f"{one_line(given['repair'])} with {one_line(given['baseline'])}"
    typer.echo(f"Building {one_line(system)}, to compare {arms}.", err=as_json)

    from faultpath.api.audit import audits, sweep_page
    from faultpath.api.comparing import compare
    from faultpath.api.display import SafeConsole
    from faultpath.report.comparison import shown

    console = SafeConsole(stderr=as_json)
    runs = audits(system, **given, progress=display(as_json))
    if as_json:
        _print_json(runs)
    if len(runs) == 1 or details:
        _print(console, runs, details)
    if len(runs) > 1:
        compared = compare(runs)
        page = compared.report(sweep_page(runs, given.get("folder")))
        console.print(shown(compared.runs))
        console.print(f"Page: {page}", markup=False, soft_wrap=True)
    return FOUND if any(run.failed for run in runs) else 0


@takes(Running, *Question.model_fields)
def study(
    study: Annotated[
        Path, typer.Option(parser=path, help="Study file that `faultpath plan` wrote.")
    ],
    as_json: Json = False,
    **running: Any,
) -> int:
    """Carry out the audits of a study file. The file says system, variants, faults, scenes and
    seeds; the same command resumes."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.planned import audit_study
    from faultpath.decisions.plan.study import read_study

    runs = audit_study(read_study(study), progress=display(as_json), **running)
    if as_json:
        _print_json(runs)
    _print(SafeConsole(stderr=as_json), runs)
    return FOUND if any(run.failed for run in runs) else 0


@takes(MapQuestion)
def reversal_map(system: SystemName, as_json: Json = False, **given: Any) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error turns it."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.mapping import reversal_map

    run = reversal_map(system, **given, progress=display(as_json))

    from faultpath.report.map import shown

    if as_json:
        typer.echo(run.record.model_dump_json(indent=1))
    else:
        console = SafeConsole()
        console.print(shown(run.record))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FOUND if run.record.failed else 0


def _print(console: "SafeConsole", runs: "Sequence[Run]", details: bool = False) -> None:
    """Print what was decided in each run."""
    from faultpath.report.terminal import decision

    for run in runs:
        if len(runs) > 1:
            console.print(f"\nFault {run.record.question.fault}", markup=False)
        console.print(decision(run.record, details))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)


def _print_json(runs: "Sequence[Run]") -> None:
    """Print folder and record of each run, of several sizes with what stands over all of them."""
    from faultpath.api.comparing import compare, folder_and_record

    several = len(runs) > 1
    found = compare(runs).as_json()["runs"] if several else [folder_and_record(runs[0].folder)]
    typer.echo(json.dumps(found, indent=1))
