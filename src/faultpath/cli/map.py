"""`faultpath map`: who is ahead over the errors at two modules of one source."""

import sys
from typing import Annotated, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FAILED_TRIALS, SYSTEM
from faultpath.trials.question import MapQuestion


@takes(MapQuestion)
def command(
    system: Annotated[str, typer.Argument(help=SYSTEM)],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
    **given: Any,
) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error turns it."""
    from faultpath.api.display import Display, SafeConsole
    from faultpath.api.mapping import reversal_map

    display = Display(SafeConsole(stderr=as_json), ("faultpath", *sys.argv[1:]))
    run = reversal_map(system, **given, progress=display)

    from faultpath.report.map import shown

    console = SafeConsole()
    if as_json:
        typer.echo(run.record.model_dump_json(indent=1))
    else:
        console.print(shown(run.record))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FAILED_TRIALS if run.record.failed else 0
