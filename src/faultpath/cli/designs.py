"""`faultpath map`: many errors of one source."""

from typing import Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FOUND, Json, SystemName, display
from faultpath.trials.question import MapQuestion


@takes(MapQuestion)
def reversal_map(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error reverses that."""
    from faultpath.api.designs import map
    from faultpath.api.display import SafeConsole

    run = map(system, **arguments, progress=display(as_json))
    if as_json:
        typer.echo(run.record.model_dump_json(indent=1))
    else:
        from faultpath.report.map import tables
        from faultpath.report.terminal import conclusion

        console = SafeConsole()
        console.print(conclusion(run.record, tables(run.record)))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FOUND if run.record.failed else 0
