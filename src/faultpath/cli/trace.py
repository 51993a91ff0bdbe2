"""`faultpath trace`: who reads what, as declared and over a few steps."""

import sys
from typing import Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import SYSTEM
from faultpath.trials.question import TraceQuestion, ask

FOUND = 1


@takes(TraceQuestion)
def command(
    system: Annotated[str, typer.Argument(help=SYSTEM)],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
    **given: Any,
) -> int:
    """Print the information interface of a system and who read what, when.

    Exits with 1 where that differs from what is declared."""
    from faultpath.api.asking import begin
    from faultpath.api.display import Display, SafeConsole
    from faultpath.api.reviewing import traced
    from faultpath.decisions.tables.terminal import STYLES, Parted
    from faultpath.report.terminal import interface_table
    from faultpath.report.trace import trace_table

    asked = ask(TraceQuestion, given, command=True)
    display = Display(SafeConsole(stderr=True), ("faultpath", *sys.argv[1:]))
    chosen = begin("trace", system, asked, display).chosen
    trace = traced(chosen, asked)
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
