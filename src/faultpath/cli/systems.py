"""`faultpath init`, `trace` and `check`: the verbs for a system of one's own."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FOUND, Json, SystemName, display
from faultpath.run.question import CheckQuestion, TraceQuestion


def init(
    name: Annotated[str, typer.Argument(help="Of the system; its file is NAME.py.")],
    kind: Annotated[
        Literal["numpy", "torch", "gymnasium"],
        typer.Option("--with", help="What it is written with."),
    ] = "numpy",
) -> int:
    """Write a system that runs, and its test, into the working directory."""
    from faultpath.system.init import TEMPLATES, write_system

    system, test = write_system(name, kind, Path())
    baseline, parameter = TEMPLATES[kind]
    typer.echo(
        f"Wrote {system} and {test}. Next:\n"
        f"  faultpath check {system}:create\n"
        f"  faultpath audit {system}:create --baseline {baseline} "
        f"--repair typical --fault {parameter}:scale=0.6\n"
        f"  python -m pytest {test}  (needs `pip install pytest`)"
    )
    return 0


@takes(TraceQuestion)
def trace(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Print the information interface of a system and who read what, when.

    Exits with 1 where that differs from what is declared."""
    from faultpath.api.display import SafeConsole
    from faultpath.api.job import begin
    from faultpath.report.checks import interface_table, trace_report_of, trace_table
    from faultpath.report.terminal import STYLES, Parted
    from faultpath.run.check.tracing import trace_system

    question, chosen, _, _ = begin("api.trace", TraceQuestion, system, arguments, display())
    trace = trace_report_of(trace_system(chosen.system, chosen.spec, question))
    if as_json:
        typer.echo(trace.model_dump_json(indent=2))
        return FOUND if trace.findings else 0
    console = SafeConsole()
    table = trace_table(trace)
    console.print(interface_table(chosen.system.interface), "")
    console.print(Parted(table))
    for text in (*table.notes, *trace.privileged):
        console.print(text, markup=False)
    for finding in trace.findings:
        console.print(f"Found: {finding}", markup=False, style=STYLES["bad"])
    if not trace.findings:
        console.print("What ran is what is declared.", style=STYLES["good"])
    return FOUND if trace.findings else 0


@takes(CheckQuestion)
def check(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Check what a careful reviewer would: that trials repeat and can be paired, that modules read
    what is declared, and that a fault reaches every injection point. Exits with 1 where a check
    fails."""
    from faultpath.api.checks import check
    from faultpath.api.display import SafeConsole
    from faultpath.report.checks import check_lines

    report = check(system, **arguments, progress=display())
    if as_json:
        typer.echo(report.model_dump_json(indent=2))
    else:
        SafeConsole().print(check_lines(report))
    return FOUND if report.failures else 0
