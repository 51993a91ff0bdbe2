"""A page of the paper as data: its tables, row by row, and so what it needs flown and measured."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from faultpath.evidence import Measurement
from faultpath.record import Sweep
from faultpath.studies.cells import Cell
from faultpath.studies.entries import Figure, Group, success
from faultpath.studies.notes import flown, recorded
from faultpath.studies.results import Results
from faultpath.tables import Line, Table

Built: TypeAlias = tuple[Table | Sweep, ...]


@dataclass(frozen=True)
class Row:
    """A line of a table; one without groups is a heading inside it."""

    label: str
    groups: tuple[Group, ...] = ()

    def lines(self, results: Results) -> tuple[Line, ...]:
        """Return the line as a run fills it."""
        entries = tuple(entry for group in self.groups for entry in group.entries(results))
        return (Line(label=self.label, entries=entries),)


@dataclass(frozen=True)
class Columns:
    """Lines whose entries are made column by column: a group a column, an entry a line."""

    labels: tuple[str, ...]
    """An empty one leaves its line out; entries beyond the labels are not shown."""
    groups: tuple[Group, ...]

    def lines(self, results: Results) -> tuple[Line, ...]:
        """Return the lines as a run fills them."""
        columns = [group.entries(results) for group in self.groups]
        return tuple(
            Line(label=label, entries=tuple(column[at] for column in columns))
            for at, label in enumerate(self.labels)
            if label
        )


Rows: TypeAlias = tuple[Row | Columns, ...]


def rates(label: str, cells: Iterable[Cell], papers: Sequence[Figure]) -> Row:
    """Return a row of success in percent."""
    pairs = zip(cells, papers, strict=True)
    return Row(label, tuple(success(cell, paper) for cell, paper in pairs))


class Part(Protocol):
    """A table or a figure of a page."""

    @property
    def cells(self) -> tuple[Cell, ...]:
        """What it needs flown."""
        ...

    @property
    def measurements(self) -> tuple[Measurement, ...]:
        """What it needs measured."""
        ...

    def build(self, results: Results) -> Table | Sweep:
        """Return it as a run fills it, with any part of its cells; never raises `NotRun`."""
        ...


@dataclass(frozen=True)
class TableSpec:
    """A table: what stands in it, and where that comes from."""

    name: str
    """Such as `table-2`; several of one page are `table-6a`, `table-6b`."""
    title: str
    columns: tuple[str, ...]
    rows: Rows
    notes: tuple[str, ...] = ()
    """`{flown}` and `{recorded}` stand for what a run holds of the cells and measurements."""

    @property
    def cells(self) -> tuple[Cell, ...]:
        """Cells of all its entries."""
        return tuple(cell for row in self.rows for group in row.groups for cell in group.cells)

    @property
    def measurements(self) -> tuple[Measurement, ...]:
        """Measurements of all its entries."""
        return tuple(m for row in self.rows for group in row.groups for m in group.measurements)

    def build(self, results: Results) -> Table:
        """Return the table as a run fills it."""
        held = {
            "flown": flown(results, self.cells),
            "recorded": recorded(results, self.measurements),
        }
        return Table(
            name=self.name,
            title=self.title,
            columns=self.columns,
            lines=tuple(line for row in self.rows for line in row.lines(results)),
            notes=tuple(note.format(**held) for note in self.notes),
        )


@dataclass(frozen=True)
class Page:
    """One table or figure of the paper, or its results in the text."""

    name: str
    """Such as `table-2`."""
    title: str
    parts: tuple[Part, ...]

    @property
    def cells(self) -> tuple[Cell, ...]:
        """What the page needs flown."""
        return tuple(cell for part in self.parts for cell in part.cells)

    @property
    def measurements(self) -> tuple[Measurement, ...]:
        """What the page needs measured."""
        return tuple(each for part in self.parts for each in part.measurements)

    def build(self, results: Results) -> Built:
        """Return tables and figures of what a run holds of the page; never raises `NotRun`."""
        return tuple(part.build(results) for part in self.parts)
