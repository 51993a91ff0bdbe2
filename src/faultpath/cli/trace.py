"""`faultpath trace`: who reads what, as declared and over a few steps."""

from typing import Annotated

import typer

from faultpath.cli.options import SET
from faultpath.question import LARGEST, settings

FOUND = 1


def command(
    system: Annotated[
        str, typer.Argument(help="`quadrotor`, `module:attribute` or `file.py:attribute`.")
    ],
    variant: Annotated[str | None, typer.Option(help="Variant; default the first.")] = None,
    steps: Annotated[int, typer.Option(min=1, help="Control steps to trace.")] = 3,
    scene: Annotated[str | None, typer.Option(help="Scene by its id; default the first.")] = None,
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "selection",
    seed: Annotated[int, typer.Option(min=0, max=LARGEST, help="Seed of the trial.")] = 0,
    fault: Annotated[
        str | None, typer.Option(help="A fault, as in `audit`, to see whom it reaches.")
    ] = None,
    options: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> int:
    """Print the information interface of a system and who read what, when.

    Exits with 1 where that differs from what is declared."""
    from faultpath.door.display import SafeConsole
    from faultpath.door.reviewing import traced
    from faultpath.door.systems import choose
    from faultpath.report.terminal import interface_table
    from faultpath.report.trace import trace_table
    from faultpath.tables.terminal import STYLES, Parted

    chosen = choose(system, settings(options or []), None, (variant,) if variant else ())
    trace = traced(chosen, variant, library, scene, steps, seed, fault)
    console = SafeConsole()
    if as_json:
        typer.echo(trace.model_dump_json(indent=2))
    else:
        console.print(interface_table(chosen.system.interface), "")
        table = trace_table(trace)
        console.print(Parted(table))
        for said in (*table.notes, *trace.privileged):
            console.print(said, markup=False)
        for finding in trace.findings:
            console.print(f"Found: {finding}", markup=False, style=STYLES["bad"])
        if not trace.findings:
            console.print("What ran is what is declared.", style=STYLES["good"])
    return FOUND if trace.findings else 0
