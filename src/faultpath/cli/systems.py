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
    from faultpath.report.terminal import STYLES, Parted, interface_table, trace_table
    from faultpath.run.check.tracing import trace_system

    question, chosen, _, _ = begin("api.trace", TraceQuestion, system, arguments, display())
    trace = trace_system(chosen.system, chosen.spec, question)
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
    from rich.padding import Padding
    from rich.text import Text

    from faultpath.api.checks import check
    from faultpath.api.display import SafeConsole
    from faultpath.core.text import counted
    from faultpath.report.terminal import STYLES

    report = check(system, **arguments, progress=display())
    if as_json:
        typer.echo(report.model_dump_json(indent=2))
        return FOUND if report.failures else 0
    console = SafeConsole()
    styles = {"passed": STYLES["good"], "failed": STYLES["bad"], "not judged": STYLES["faint"]}
    scenes = f"{len(report.scenes)} of {counted(report.of, 'scene')} of {report.library}"
    fault = f", and with {report.fault}" if report.fault else ""
    about = f"{', '.join(report.variants)} in {scenes}, seed {report.seed}{fault}"
    console.print(Text(f"{report.system}: {about}", "bold"))
    unjudged: dict[str, list[str]] = {}
    for result in report.checks:
        if result.status == "not judged" and not result.remarks:
            unjudged.setdefault(result.says, []).append(result.name)
            continue
        status = Text(result.status, styles[result.status])
        console.print(Text.assemble(status, f"  {result.name}: {result.says}"))
        for text in (*result.failures, *(f"Remark: {remark}" for remark in result.remarks)):
            console.print(Padding(Text(f"- {text}"), (0, 0, 0, 2)))
    for says, names in unjudged.items():
        status = Text("not judged", styles["not judged"])
        console.print(Text.assemble(status, f"  {', '.join(names)}: {says}"))
    failed = sum(result.status == "failed" for result in report.checks)
    remarks = counted(sum(len(result.remarks) for result in report.checks), "remark")
    text = f"{counted(failed, 'check')} failed" if failed else "No check failed"
    text += "." if remarks.startswith("0") else f"; {remarks}."
    console.print(Text(text, STYLES["bad" if failed else "good"]))
    return FOUND if report.failures else 0
