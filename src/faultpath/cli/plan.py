"""`faultpath plan`: what to audit first, as a study file that `faultpath audit --study` runs."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import SYSTEM, path
from faultpath.trials.question import PlanQuestion


@takes(PlanQuestion)
def command(
    system: Annotated[str, typer.Argument(help=SYSTEM)],
    out: Annotated[Path, typer.Option(parser=path, help="Study file to write.")] = Path(
        "study.yaml"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
    **given: Any,
) -> None:
    """Rank the uncertain sources, propose the audits of a repair with their trials, and
    write them as a study file for `faultpath audit --study`."""
    from faultpath.api.display import Display, SafeConsole
    from faultpath.api.planned import check_new, plan

    check_new(out)
    display = Display(SafeConsole(stderr=True), ("faultpath", *sys.argv[1:]))
    found = plan(system, **given, progress=display)
    written = found.write(out)

    from faultpath.decisions.tables.terminal import drawn
    from faultpath.report.plan import by_audit, by_rank, by_response

    if as_json:
        typer.echo(found.plan.model_dump_json(indent=2))
        return
    console = SafeConsole()
    moved = any(each.response is not None for each in found.plan.candidates)
    told = (by_rank, by_response, by_audit) if moved else (by_rank, by_audit)
    for table in (each(found.plan) for each in told):
        console.print(drawn(table))
        for note in table.notes:
            console.print(note, markup=False)
        console.print()
    for sentence in found.sentences:
        console.print(sentence, markup=False)
    console.print(f"Written: {written}", markup=False, soft_wrap=True)
