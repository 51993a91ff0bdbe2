"""`faultpath map`, `search` and `sensitivity`: many faults of one system."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import typer

from faultpath.cli.flags import takes
from faultpath.cli.options import FOUND, Json, SystemName, display
from faultpath.trials.question import MapQuestion, SearchQuestion, SensitivityQuestion

if TYPE_CHECKING:
    from faultpath.api.runs import FinishedRun
    from faultpath.decisions.tables import Table


@takes(MapQuestion)
def reversal_map(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Map the success difference over the error at one module and that at another: where repair
    or baseline is ahead, from which correlation of the errors on, and which error reverses that."""
    from faultpath.api.designs import map

    run = map(system, **arguments, progress=display(as_json))

    from faultpath.report.map import tables

    return _tell(run, tables(run.record), as_json)


@takes(SearchQuestion)
def search(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Look within bounds for the fault that hurts those most who choose the repair by an isolated
    audit: half of the scenes find it, and an audit in the other half tests it."""
    from faultpath.api.designs import search

    run = search(system, **arguments, progress=display(as_json))

    from faultpath.report.search import tables

    return _tell(run, tables(run.record), as_json)


@takes(SensitivityQuestion)
def sensitivity(system: SystemName, as_json: Json = False, **arguments: Any) -> int:
    """Tell which source is worth improving: Sobol indices of a metric over errors that are drawn
    as the interface declares them, with sources of one correlation group moved together."""
    from faultpath.api.designs import sensitivity

    run = sensitivity(system, **arguments, progress=display(as_json))

    from faultpath.report.sensitivity import table

    return _tell(run, [table(run.record)], as_json)


def _tell(run: "FinishedRun", tables: "Iterable[Table]", as_json: bool) -> int:
    """Print the record of a map, a search or a sensitivity analysis; return the status."""
    from faultpath.api.display import SafeConsole
    from faultpath.report.terminal import conclusion

    if as_json:
        typer.echo(run.record.model_dump_json(indent=1))
    else:
        console = SafeConsole()
        console.print(conclusion(run.record, tables))
        console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    return FOUND if run.record.failed else 0
