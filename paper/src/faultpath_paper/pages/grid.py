"""Tables of success: a cell for each row and column, and what the paper prints of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from faultpath_paper.cells import Cell, Printed
from faultpath_paper.entries import difference, published_contrasts
from faultpath_paper.page import Columns, Rows, TableRow, rates

DIFFERENCE = ("Difference", "95 % interval", "Score interval", "Wins:losses")
"""Headings of the first of what `difference` makes."""


@dataclass(frozen=True)
class Grid:
    """Rows are variants; columns are faults, or settings."""

    cell: Callable[[str, Any], Cell]
    names: Mapping[str, str]
    """Keys of the rows in print."""
    columns: tuple[Any, ...]
    figures: Mapping[str, Any]
    """Figures of the paper, by the key of a row, or of two rows for their difference."""

    def rate(self, row: str, column: Any) -> float:
        """Return the success that the paper prints, percent."""
        return self.figures[self.names[row]][self.columns.index(column)]

    def contrast(self, first: str, second: str, column: Any) -> Printed | None:
        """Return what the paper prints of one row minus another, pp; `None` for nothing."""
        if (paper := self.figures.get(self._minus(first, second))) is None:
            return None
        at = self.columns.index(column)
        low, high = paper["ci95"][at]
        return Printed(paper["pp"][at], (low, high))

    def rates(self, row: str, label: str = "") -> TableRow:
        """Return a row of success, by default under its key in print."""
        cells = (self.cell(row, column) for column in self.columns)
        return rates(label or self.names[row], cells, self.figures[self.names[row]])

    def differences(self, first: str, second: str, unit: str) -> Rows:
        """Return the rows that `DIFFERENCE` names, below a heading that ends in the unit."""
        paper = self.figures[self._minus(first, second)]
        columns = zip(self.columns, published_contrasts(**paper), strict=True)
        groups = (
            difference(self.cell(first, column), self.cell(second, column), printed)
            for column, printed in columns
        )
        heading = TableRow(f"{self.names[first]} minus {self.names[second]}{unit}")
        return heading, Columns(DIFFERENCE, tuple(groups))

    def _minus(self, first: str, second: str) -> str:
        return f"{self.names[first]}_minus_{self.names[second]}"
