"""A table as text, and as HTML and Markdown: whoever fills it writes its numbers."""

from collections.abc import Iterable, Iterator
from typing import Literal

from markupsafe import Markup
from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

from faultpath.report.escapes import html as escape
from faultpath.report.escapes import markdown as markdown_escape
from faultpath.report.escapes import unbroken

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
    """Whether it is a significant difference, printed in bold."""
    aside: str = ""
    """Qualification, such as `ceiling`: stands behind it in parentheses."""
    tone: Tone = ""


class Line(_Sparse):
    """A row; one without entries is a heading inside the table."""

    label: str
    entries: tuple[Entry, ...] = ()
    aside: str = ""
    """Qualification of the label."""


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


def line(label: str, *entries: str | Entry, aside: str = "") -> Line:
    """Return a line whose plain texts are entries."""
    cells = tuple(Entry(text=entry) if isinstance(entry, str) else entry for entry in entries)
    return Line(label=label, entries=cells, aside=aside)


def html(table: Table, style: str = "numbers", *, caption: bool = True) -> Markup:
    """Return the `table` element, without its notes, with a body for each inner heading."""
    span = len(table.columns) + 1
    corner = f'<th scope="col">{escape(table.corner)}</th>' if table.corner else "<td></td>"
    classes = [' class="word"' if column in table.words else "" for column in table.columns]
    heads = "".join(
        f'<th scope="col"{of}>{escape(column)}</th>'
        for column, of in zip(table.columns, classes, strict=True)
    )
    title = f"<caption>{escape(table.title)}</caption>" if caption else ""
    parts = [f'<table class="{escape(style)}">{title}', f"<thead><tr>{corner}{heads}</tr></thead>"]
    for heading, lines in table.blocks():
        parts.append("<tbody>")
        if heading:
            parts.append(
                f'<tr class="heading"><th scope="rowgroup" colspan="{span}">'
                f"<span>{escape(heading)}</span></th></tr>"
            )
        for line in lines:
            entries = "".join(map(_html_entry, line.entries, classes))
            entries += "<td></td>" * (span - 1 - len(line.entries))
            label = f"{escape(line.label)}{_aside(line.aside)}"
            parts.append(f'<tr><th scope="row">{label}</th>{entries}</tr>')
        parts.append("</tbody>")
    return Markup("\n".join([*parts, "</table>"]))


def _html_entry(entry: Entry, of_column: str = "") -> str:
    mark = " found" if entry.detected else ""
    alarm = ' class="alarm"' if entry.tone == "bad" else of_column
    theirs = ""
    if entry.published:
        aloud = '<span class="aloud">paper </span>'
        theirs = f'<span class="theirs">{aloud}{escape(entry.published)}</span>'
    text = f"{escape(unbroken(entry.text))}{_aside(entry.aside)}"
    return f'<td{alarm}><span class="ours{mark}">{text}</span>{theirs}</td>'


def _aside(text: str) -> str:
    return f" <small>({escape(text)})</small>" if text else ""


def markdown_block(table: Table) -> str:
    """Return title, table and notes, each a block of its own."""
    notes = [f"- {markdown_escape(note)}" for note in (*table.legend(), *table.notes)]
    return "\n".join(
        [f"**{markdown_escape(table.title)}**", "", markdown_grid(table), "", *notes, ""]
    )


def markdown_blocks(tables: Iterable[Table]) -> str:
    """Return tables one below the other."""
    return "\n\n".join(map(markdown_block, tables))


def markdown_grid(table: Table) -> str:
    """Return the lines of the table alone."""
    rows = [
        [markdown_escape(text) for text in (table.corner, *table.columns)],
        [":--", *(":--" if column in table.words else "--:" for column in table.columns)],
    ]
    for line in table.lines:
        if not line.entries:
            rows.append([f"*{markdown_escape(line.label)}*", *[""] * len(table.columns)])
            continue
        label = markdown_escape(line.label)
        label += f" ({markdown_escape(line.aside)})" if line.aside else ""
        rows.append([label, *map(_markdown_entry, line.entries)])
    return "\n".join(f"| {f'{row[0]} ' if row[0] else ''}| {' | '.join(row[1:])} |" for row in rows)


def _markdown_entry(entry: Entry) -> str:
    text = markdown_escape(entry.text)
    if entry.detected or entry.tone == "bad":
        text = f"**{text}**"
    behind = (entry.aside, entry.published)
    return " ".join([text, *(f"({markdown_escape(part)})" for part in behind if part)])
