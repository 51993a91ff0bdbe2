"""A page of the paper as data: its tables row by row, with the cells and measurements they need."""

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import compress
from typing import TypeAlias

from faultpath.core.text import counted
from faultpath.report.sentences import wording
from faultpath.report.tables import Line, Table
from faultpath_paper.answers import Sweep
from faultpath_paper.cells import Cell, data
from faultpath_paper.entries import EntryGroup, Figure, success
from faultpath_paper.evidence.table import Measured, Measurement
from faultpath_paper.results import NotRun, Results


def flown(results: Results, cells: Iterable[Cell]) -> str:
    """Return the scenes and seeds of cells in a run, library by library, in a sentence."""
    libraries: dict[str, tuple[set[str], set[int]]] = {}
    for cell in cells:
        with suppress(NotRun):
            run_seeds = results.seeds(cell)
            scenes, seeds = libraries.setdefault(cell.setting.library, (set(), set()))
            seeds.update(run_seeds)
            rows = results.trials.rows(cell.variant, cell.condition, run_seeds[:1])[0]
            scenes.update(scene.id for scene in compress(results.trials.scenes, rows >= 0))
    if not libraries:
        return "No trial of this table was run."
    parts = (
        f"{counted(len(scenes), 'scene')} of the {library} library, "
        f"{wording.seeds(tuple(sorted(seeds)))}"
        for library, (scenes, seeds) in libraries.items()
    )
    return wording.sentence("; ".join(parts))


def recorded(results: Results, measurements: Iterable[Measurement]) -> str:
    """Return the windows, scenes, library and seeds of one recording in a run, in a sentence."""
    measured: dict[Measurement, Measured] = {}
    for measurement in measurements:
        with suppress(NotRun):
            measured[measurement] = results.measured(measurement)
    if not measured:
        return "No error of this table was measured."
    measurement, windows = next(iter(measured.items()))
    library = measurement.recording.library
    scenes = counted(len(set(windows.scenes)), "scene")
    seeds = wording.seeds(tuple(sorted({measurement.seed for measurement in measured})))
    return f"{len(windows):,} windows of {scenes} of the {library} library, {seeds}."


Built: TypeAlias = tuple[Table | Sweep, ...]


@dataclass(frozen=True)
class TableRow:
    """A line of a table; one without groups is a heading inside it."""

    label: str
    groups: tuple[EntryGroup, ...] = ()

    def lines(self, results: Results) -> tuple[Line, ...]:
        """Return the line as a run fills it."""
        entries = tuple(entry for group in self.groups for entry in group.entries(results))
        return (Line(label=self.label, entries=entries),)


@dataclass(frozen=True)
class Columns:
    """Lines whose entries are made column by column: a group a column, an entry a line."""

    labels: tuple[str, ...]
    """An empty one leaves its line out; entries beyond the labels are not shown."""
    groups: tuple[EntryGroup, ...]

    def lines(self, results: Results) -> tuple[Line, ...]:
        """Return the lines as a run fills them."""
        columns = [group.entries(results) for group in self.groups]
        return tuple(
            Line(label=label, entries=tuple(column[at] for column in columns))
            for at, label in enumerate(self.labels)
            if label
        )


Rows: TypeAlias = tuple[TableRow | Columns, ...]


def rates(label: str, cells: Iterable[Cell], papers: Sequence[Figure]) -> TableRow:
    """Return a row of success in percent."""
    pairs = zip(cells, papers, strict=True)
    return TableRow(label, tuple(success(cell, paper) for cell, paper in pairs))


@dataclass(frozen=True)
class TableSpec:
    """A table: its rows, and the cells and measurements that they come from."""

    name: str
    """Such as `table-2`; several of one page are `table-6a`, `table-6b`."""
    title: str
    columns: tuple[str, ...]
    rows: Rows
    notes: tuple[str, ...] = ()
    """`{flown}` and `{recorded}` are filled by the functions of these names."""

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
        fields = {
            "flown": flown(results, self.cells),
            "recorded": recorded(results, self.measurements),
        }
        return Table(
            name=self.name,
            title=self.title,
            columns=self.columns,
            lines=tuple(line for row in self.rows for line in row.lines(results)),
            notes=tuple(note.format(**fields) for note in self.notes),
        )


def table(name: str, *rows: TableRow | Columns, **numbers: object) -> TableSpec:
    """Return a table with its title, headings and notes of `data/tables.yaml`; `numbers` are what
    its notes name beside `{flown}` and `{recorded}`."""
    texts = data("tables.yaml")
    own, fields = texts[name], {"flown": "{flown}", "recorded": "{recorded}", **texts["notes"]}
    notes = (note.format(**fields, **numbers) for note in own["notes"])
    return TableSpec(name, own["title"], tuple(own["columns"]), rows, tuple(notes))


@dataclass(frozen=True)
class FigureSpec:
    """A figure of lines, and the cells and measurements that they come from."""

    build: Callable[[Results], Sweep]
    """Makes the figure from a run."""
    cells: tuple[Cell, ...]
    measurements: tuple[Measurement, ...] = ()


@dataclass(frozen=True)
class Page:
    """One table or figure of the paper, or its results in the text."""

    name: str
    """Such as `table-2`."""
    parts: tuple[TableSpec | FigureSpec, ...] = ()
    more_cells: tuple[Cell, ...] = ()
    """Cells that none of its parts shows."""
    more_measurements: tuple[Measurement, ...] = ()

    @property
    def cells(self) -> tuple[Cell, ...]:
        """Cells that the page needs run."""
        return (*self.more_cells, *(cell for part in self.parts for cell in part.cells))

    @property
    def measurements(self) -> tuple[Measurement, ...]:
        """Measurements that the page needs."""
        return (*self.more_measurements, *(m for part in self.parts for m in part.measurements))

    def build(self, results: Results) -> Built:
        """Return the page's tables and figures as a run fills them; never raises `NotRun`."""
        return tuple(part.build(results) for part in self.parts)


def page_of(name: str, *rows: TableRow | Columns) -> Page:
    """Return the page of one table, which has its name."""
    return Page(name, (table(name, *rows),))
