"""A table as text: whoever fills it writes its numbers, and a renderer only sets them."""

from collections.abc import Iterator
from typing import Literal

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

MISSING = "–"
"""Where the run holds nothing for an entry."""
Tone = Literal["", "good", "bad", "faint"]
"""How a terminal or a page colours an entry; what is bad is bold wherever there is no colour."""


class _Sparse(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @model_serializer(mode="wrap")
    def _without_what_is_empty(self, dump: SerializerFunctionWrapHandler) -> dict[str, object]:
        # Files of tables are mostly defaults otherwise.
        fields = type(self).model_fields
        return {k: v for k, v in dump(self).items() if v or fields[k].is_required()}


class Entry(_Sparse):
    """Entry of a table, where a line and a column meet."""

    text: str
    """Ours, as printed."""
    published: str = ""
    """The paper's, as printed; empty where it gives none."""
    detected: bool = False
    """Whether it is a detected difference, printed in bold."""
    aside: str = ""
    """Qualification, such as `ceiling`: stands behind it in parentheses."""
    tone: Tone = ""
    name: bool = False
    """Whether it is a name or a digest, set as code where there is such a type."""


class Line(_Sparse):
    """A row; one without entries is a heading inside the table."""

    label: str
    entries: tuple[Entry, ...] = ()
    aside: str = ""
    """Qualification of the label."""
    name: bool = False
    """Whether the label is the name of something, set as code."""


class Table(_Sparse):
    """Lines of entries below headings."""

    name: str = ""
    """Such as `table-2`; several parts of one page are `table-6a`, `table-6b`."""
    title: str = ""
    columns: tuple[str, ...]
    """Headings of the entries."""
    lines: tuple[Line, ...]
    notes: tuple[str, ...] = ()
    """Remarks for the reader: units, seeds, scenes, what differs from the paper's."""
    corner: str = ""
    """Heading of the labels."""
    words: tuple[str, ...] = ()
    """The columns that hold words, which stand to the left, and no numbers."""

    def legend(self) -> tuple[str, ...]:
        """Return what the marks of the entries mean, where there are any."""
        entries = [entry for line in self.lines for entry in line.entries]
        marks = (
            ("In parentheses: the paper's figures.", any(entry.published for entry in entries)),
            ("Bold: significant.", any(entry.detected for entry in entries)),
        )
        text = " ".join(words for words, there in marks if there)
        return (text,) if text else ()

    def blocks(self) -> Iterator[tuple[str, tuple[Line, ...]]]:
        """Yield the lines cut at the inner headings; the first heading may be empty."""
        heading, lines = "", list[Line]()
        for row in self.lines:
            if row.entries:
                lines.append(row)
                continue
            if heading or lines:
                yield heading, tuple(lines)
            heading, lines = row.label, []
        yield heading, tuple(lines)


def line(label: str, *entries: str | Entry, name: bool = False, aside: str = "") -> Line:
    """Return a line whose plain texts are entries."""
    cells = tuple(Entry(text=entry) if isinstance(entry, str) else entry for entry in entries)
    return Line(label=label, entries=cells, name=name, aside=aside)
