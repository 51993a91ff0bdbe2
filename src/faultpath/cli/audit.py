"""`faultpath audit`: run the arms of one question, decide, report."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FAILED_TRIALS, SYSTEM, path
from faultpath.core.text import one_line
from faultpath.trials.question import AuditQuestion

if TYPE_CHECKING:
    from faultpath.api.display import SafeConsole
    from faultpath.api.run import Run

Json = Annotated[
    bool,
    typer.Option(
        "--json", help="Print folder and record of each audit as JSON; words go to stderr."
    ),
]


@takes(AuditQuestion)
def command(
    system: Annotated[str, typer.Argument(help=SYSTEM)],
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

    from faultpath.api.audit import audits
    from faultpath.api.display import Display, SafeConsole

    console = SafeConsole(stderr=as_json)
    runs = audits(system, **given, progress=Display(console, ("faultpath", *sys.argv[1:])))
    if as_json:
        tell_json(runs)
    if len(runs) > 1:
        if details:
            tell(console, runs, details)
        return _tell_sweep(console, runs, given.get("folder"))
    return tell(console, runs, details)


@takes(
    AuditQuestion,
    *(
        name
        for name in AuditQuestion.model_fields
        if name not in ("folder", "workers", "executor", "time_limit_s")
    ),
)
def study(
    study: Annotated[
        Path, typer.Option(parser=path, help="Study file that `faultpath plan` wrote.")
    ],
    as_json: Json = False,
    **running: Any,
) -> int:
    """Carry out the audits of a study file. The file says system, variants, faults, scenes and
    seeds; the same command resumes."""
    from faultpath.api.display import Display, SafeConsole
    from faultpath.api.planned import audit_study
    from faultpath.decisions.plan.study import read_study

    console = SafeConsole(stderr=as_json)
    progress = Display(console, ("faultpath", *sys.argv[1:]))
    runs = audit_study(read_study(study), progress=progress, **running)
    if as_json:
        tell_json(runs)
    return tell(console, runs)


def _tell_sweep(console: "SafeConsole", runs: "Sequence[Run]", out: Path | None) -> int:
    """Print what was decided at each size, side by side, and write it as one page too."""
    from faultpath.api.audit import sweep_page
    from faultpath.api.comparing import compare
    from faultpath.report.comparison.page import shown

    compared = compare(runs)
    page = compared.report(sweep_page(runs, out))
    console.print(shown(compared.runs))
    console.print(f"Page: {page}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if any(run.failed for run in runs) else 0


def tell(console: "SafeConsole", runs: "Sequence[Run]", details: bool = False) -> int:
    """Print what was decided in each run, and return the status of the command."""
    from faultpath.report.terminal import decision

    for run in runs:
        if len(runs) > 1:
            console.print(f"\nFault {run.record.question.fault}", markup=False)
        console.print(decision(run.record, details))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if any(run.failed for run in runs) else 0


def tell_json(runs: "Sequence[Run]") -> None:
    """Print folder and record of each run, of several sizes with what stands over all of them."""
    from faultpath.api.comparing import compare, folder_and_record

    several = len(runs) > 1
    told = compare(runs).as_json()["runs"] if several else [folder_and_record(runs[0].folder)]
    typer.echo(json.dumps(told, indent=1))
