"""`faultpath plan`: what to audit first, as a study file that `faultpath audit --study` flies."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import SET, numbers, path, settings


def command(
    system: Annotated[
        str, typer.Argument(help="As for `audit`; --help after it shows its own options too.")
    ],
    baseline: Annotated[str, typer.Option(help="Variant to compare with.")],
    repair: Annotated[str, typer.Option(help="Variant that is meant to help.")],
    fault: Annotated[
        list[str] | None,
        typer.Option(
            help="Expected error of a source that declares none, or another one: "
            "`gain:scale=1.1`; repeat the option for more."
        ),
    ] = None,
    module: Annotated[
        list[str] | None,
        typer.Option(help="Module that the repair changes, where its reads do not tell."),
    ] = None,
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "held-out",
    scenes: Annotated[int | None, typer.Option(help="Plan for only the first N scenes.")] = None,
    seeds: Annotated[
        str, typer.Option(help="Seeds of the noise, and of trained models where there are any.")
    ] = "0",
    set_: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    out: Annotated[Path, typer.Option(parser=path, help="Study file to write.")] = Path(
        "study.yaml"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Rank the uncertain sources, propose the audits of a repair with their trials, and
    write them as a study file for `faultpath audit --study`."""
    drawn, options = numbers(seeds, "--seeds"), settings(set_ or [])

    from faultpath.door.display import Display, SafeConsole
    from faultpath.door.planned import check_new, plan

    check_new(out)
    found = plan(
        system,
        baseline=baseline,
        repair=repair,
        fault=tuple(fault or ()),
        module=tuple(module or ()),
        library=library,
        scenes=scenes,
        seeds=drawn,
        options=options,
        progress=Display(SafeConsole(stderr=True), ("faultpath", *sys.argv[1:])),
    )
    written = found.write(out)

    from faultpath.report.proposal import by_audit, by_rank, by_response
    from faultpath.tables.terminal import drawn as in_terminal

    if as_json:
        typer.echo(found.plan.model_dump_json(indent=2))
        return
    console = SafeConsole()
    moved = any(each.response is not None for each in found.plan.candidates)
    told = (by_rank, by_response, by_audit) if moved else (by_rank, by_audit)
    for table in (each(found.plan) for each in told):
        console.print(in_terminal(table))
        for note in table.notes:
            console.print(note, markup=False)
        console.print()
    for sentence in found.sentences:
        console.print(sentence, markup=False)
    console.print(f"Written: {written}", markup=False, soft_wrap=True)
