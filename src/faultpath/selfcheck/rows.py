"""How the settings of a section become the rows of a table."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from faultpath.selfcheck.model import Cell, Report
from faultpath.tables import Table, line

Texts: TypeAlias = tuple[str, ...]
LEANS = {0.0: "even", 0.5: "three to one", 1.0: "one-sided"}


@dataclass(frozen=True)
class Shown:
    """A table of one section: how its settings become rows."""

    section: str
    title: str
    note: str
    rows: Callable[[Sequence[Cell]], tuple[Texts, Iterable[Texts]]]
    """Headings, the first above the labels, and rows."""
    concerns: Callable[[Cell], bool] = lambda cell: True

    def table(self, report: Report) -> Table:
        """Return it for a report."""
        cells = [cell for cell in report.section(self.section).cells() if self.concerns(cell)]
        (corner, *columns), rows = self.rows(cells)
        lines = tuple(line(label, *texts) for label, *texts in rows)
        return Table(
            title=self.title,
            corner=corner,
            columns=tuple(columns),
            lines=lines,
            notes=(self.note,),
        )


def across(
    corner: str, column: str, label: Callable[[Cell], str]
) -> Callable[[Sequence[Cell]], tuple[Texts, Iterable[Texts]]]:
    """Return rows of the range of rates by label, with a column for each value of `column`."""

    def made(cells: Sequence[Cell]) -> tuple[Texts, Iterable[Texts]]:
        values = sorted({float(cell[column]) for cell in cells})
        rows: dict[str, dict[float, list[float]]] = {}
        for cell in cells:
            at = rows.setdefault(label(cell), {})
            at.setdefault(float(cell[column]), []).append(float(cell["measured"]))
        heads = (corner, *(f"{100 * value:g} %" for value in values))
        return heads, [(name, *(spread(at[v]) for v in values)) for name, at in rows.items()]

    return made


def each(
    heads: Texts, texts: Callable[[Cell], Texts]
) -> Callable[[Sequence[Cell]], tuple[Texts, Iterable[Texts]]]:
    """Return one row for each setting, its rate last."""
    return lambda cells: (heads, [(*texts(c), share(float(c["measured"]))) for c in cells])


def spread(rates: Iterable[float]) -> str:
    """Return the least and the greatest of some rates."""
    low, high = share(min(rates := list(rates))), share(max(rates))
    return low if low == high else f"{low}–{high}"


def share(rate: float) -> str:
    """Return `.950`, or 1."""
    text = f"{rate:.3f}"
    return text.removeprefix("0") if rate < 0.9995 else "1"


def of_seeds(seeds: object) -> str:
    """Return `1 seed` or `3 seeds`."""
    return f"{seeds} seed{'' if seeds == 1 else 's'}"
