"""`faultpath check`: does a system keep what an audit takes for granted?"""

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import SET, TimeLimit, read
from faultpath.question import LARGEST, names, settings

if TYPE_CHECKING:
    from rich.console import RenderableType

    from faultpath.review.check import Report

FAILED = 1


def command(
    system: Annotated[
        str, typer.Argument(help="`quadrotor`, `module:attribute` or `file.py:attribute`.")
    ],
    variants: Annotated[
        str | None,
        typer.Option(help="Variants to check: wm-a,wm-a+dcc. Default all, or two of more than 4."),
    ] = None,
    library: Annotated[str, typer.Option(help="Library of scenes.")] = "selection",
    scenes: Annotated[int, typer.Option(help="Fly the first N scenes.")] = 4,
    seed: Annotated[int, typer.Option(min=0, max=LARGEST, help="Seed of the trials.")] = 0,
    options: Annotated[list[str] | None, typer.Option("--set", help=SET)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of lines.")] = False,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Worker processes, by default 2 where that helps; 0 is this process alone, which "
            "cannot see what differs from process to process."
        ),
    ] = None,
    time_limit: TimeLimit = None,
) -> int:
    """Check what a careful reviewer would: that trials repeat and can be paired, that modules read
    what is declared, and that a fault reaches every tap. Exits with 1 where a check fails."""
    from faultpath.door import check
    from faultpath.door.display import Display, SafeConsole

    report = check(
        system,
        variants=() if variants is None else read(names, variants, "--variants"),
        library=library,
        scenes=scenes,
        seed=seed,
        options=settings(options or []),
        workers=workers,
        time_limit_s=time_limit,
        progress=Display(SafeConsole(stderr=True), ("faultpath", *sys.argv[1:])),
    )
    if as_json:
        typer.echo(report.model_dump_json(indent=2))
    else:
        SafeConsole().print(_shown(report))
    return FAILED if report.failures else 0


def _shown(report: "Report") -> "RenderableType":
    from rich.console import Group
    from rich.padding import Padding
    from rich.text import Text

    from faultpath.record import wording
    from faultpath.tables.terminal import STYLES

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
