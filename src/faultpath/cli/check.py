"""`faultpath check`: does a system keep what an audit takes for granted?"""

import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import SYSTEM
from faultpath.trials.question import CheckQuestion

if TYPE_CHECKING:
    from rich.console import RenderableType

    from faultpath.systems.checks.check import Report

FAILED = 1


@takes(CheckQuestion)
def command(
    system: Annotated[str, typer.Argument(help=SYSTEM)],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of lines.")] = False,
    **given: Any,
) -> int:
    """Check what a careful reviewer would: that trials repeat and can be paired, that modules read
    what is declared, and that a fault reaches every tap. Exits with 1 where a check fails."""
    from faultpath.api import check
    from faultpath.api.display import Display, SafeConsole

    display = Display(SafeConsole(stderr=True), ("faultpath", *sys.argv[1:]))
    report = check(system, **given, progress=display)
    if as_json:
        typer.echo(report.model_dump_json(indent=2))
    else:
        SafeConsole().print(_shown(report))
    return FAILED if report.failures else 0


def _shown(report: "Report") -> "RenderableType":
    from rich.console import Group
    from rich.padding import Padding
    from rich.text import Text

    from faultpath.decisions import wording
    from faultpath.decisions.tables.terminal import STYLES

    styles = {"passed": STYLES["good"], "failed": STYLES["bad"], "not judged": STYLES["faint"]}
    met = f"{wording.counted(len(report.scenes), 'scene')} of {report.library}, seed {report.seed}"
    parts: list[RenderableType] = [
        Text(f"{report.system}: {', '.join(report.variants)} in {met}", "bold")
    ]
    for check in report.checks:
        status = Text(check.status, styles[check.status])
        parts.append(Text.assemble(status, f"  {check.name}: {check.says}"))
        told = (*check.failures, *(f"Remark: {said}" for said in check.remarks))
        parts += [Padding(Text(f"- {said}"), (0, 0, 0, 2)) for said in told]
    failed = sum(check.status == "failed" for check in report.checks)
    said = f"{wording.counted(failed, 'check')} failed." if failed else "No check failed."
    return Group(*parts, Text(said, STYLES["bad" if failed else "good"]))
