"""The tables of a self-check in the terminal."""

from rich.console import Console

from faultpath.selfcheck.model import Report
from faultpath.selfcheck.words import tables
from faultpath.tables.terminal import drawn


def show(report: Report, console: Console) -> None:
    """Print every table with its note."""
    for table in tables(report):
        console.print()
        console.print(drawn(table))
        console.print(*table.notes, markup=False)
