"""`faultpath map` and `scan`: many errors of one source, and of all."""

import json
from typing import Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FOUND, Json, SystemName, display
from faultpath.run.question import MapCall, ScanCall


@takes(MapCall)
def reversal_map(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error reverses that."""
    from faultpath.api.comparing import in_json
    from faultpath.api.display import SafeConsole
    from faultpath.api.rounds import map

    run = map(system, **arguments, progress=display())
    if as_json:
        typer.echo(json.dumps(in_json(run.folder, run.record), indent=1))
    else:
        from faultpath.report.map import tables
        from faultpath.report.terminal import conclusion

        console = SafeConsole()
        console.print(conclusion(run.record, tables(run.record)))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FOUND if run.record.failed else 0


@takes(ScanCall)
def scan(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Find which errors of a system's inputs cancel: each alone costs success, and both together
    less than either, so that correcting one of them alone does not help."""
    from faultpath.analyses.scan.sources import Ranking
    from faultpath.api.comparing import in_json
    from faultpath.api.display import SafeConsole
    from faultpath.api.rounds import scan
    from faultpath.report.scan import ranking_table, tables
    from faultpath.report.tables.terminal import Parted
    from faultpath.report.terminal import conclusion

    result = scan(system, **arguments, progress=display())
    console = SafeConsole()
    if isinstance(result, Ranking):
        if as_json:
            typer.echo(result.model_dump_json(indent=1))
            return 0
        table = ranking_table(result)
        console.print(Parted(table))
        for note in table.notes:
            console.print(note, markup=False)
        return 0
    if as_json:
        typer.echo(json.dumps(in_json(result.folder, result.record), indent=1))
    else:
        console.print(conclusion(result.record, tables(result.record)))
        for command in result.words.commands or ():
            console.print(f"Next: {command}", markup=False, soft_wrap=True)
        console.print(f"Report: {result.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FOUND if result.record.failed else 0
