"""A table or figure of a study, as text beside what was published: what pages render."""

from pydantic import BaseModel, ConfigDict

MISSING = "–"
"""Where the run holds nothing for an entry."""


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class Entry(_Frozen):
    """One figure of a table."""

    text: str
    """Ours, as printed."""
    published: str = ""
    """The paper's, as printed; empty where it gives none."""
    detected: bool = False
    """Whether it is a detected difference, printed in bold."""


class Line(_Frozen):
    """A row; one without entries is a heading inside the table."""

    label: str
    entries: tuple[Entry, ...] = ()


class Table(_Frozen):
    """A table of figures, each beside the published one."""

    name: str
    """Such as `table-2`; several parts of one page are `table-6a`, `table-6b`."""
    title: str
    columns: tuple[str, ...]
    """Headings of the entries."""
    lines: tuple[Line, ...]
    notes: tuple[str, ...] = ()
    """What a reader has to know: units, seeds, scenes, what differs from the paper's."""


class Point(_Frozen):
    """One point of a series, with its interval."""

    x: float
    y: float
    low: float | None = None
    high: float | None = None


class Series(_Frozen):
    """One line of a figure."""

    label: str
    points: tuple[Point, ...]


class Sweep(_Frozen):
    """A figure of lines."""

    name: str
    title: str
    x_title: str
    y_title: str
    series: tuple[Series, ...]
    published: str
    """What the paper says of its figure."""
    notes: tuple[str, ...] = ()
