"""The tables of a self-check in the terminal."""

from rich.console import Console
from rich.table import Table as Drawn

from faultpath.selfcheck.model import Report
from faultpath.selfcheck.words import tables


def show(report: Report, console: Console) -> None:
    """Print every table with its note."""
    for table in tables(report):
        console.print(f"\n[bold]{table.title}[/bold]")
        console.print(table.note, markup=False)
        drawn = Drawn(box=None, pad_edge=False)
        for i, name in enumerate(table.columns):
            drawn.add_column(name, justify="right" if i else "left")
        for row in table.rows:
            drawn.add_row(*row)
        console.print(drawn)
