"""Tables as Markdown: the paper's figure stands in parentheses behind ours."""

from faultpath.decisions.tables.escapes import markdown as escape
from faultpath.decisions.tables.model import Entry, Line, Table


def block(table: Table) -> str:
    """Return title, table and notes, each a block of its own."""
    notes = [f"- {escape(note)}" for note in (*table.legend(), *table.notes)]
    return "\n".join([f"**{escape(table.title)}**", "", grid(table), "", *notes, ""])


def grid(table: Table) -> str:
    """Return the lines of the table alone."""
    sides = (":--" if column in table.words else "--:" for column in table.columns)
    rows = [
        _row(escape(table.corner), *map(escape, table.columns)),
        _row(":--", *sides),
        *(_row(*_cells(line, len(table.columns))) for line in table.lines),
    ]
    return "\n".join(rows)


def _row(label: str, *cells: str) -> str:
    return f"| {f'{label} ' if label else ''}| {' | '.join(cells)} |"


def _cells(line: Line, width: int) -> tuple[str, ...]:
    if not line.entries:
        return (f"*{escape(line.label)}*", *[""] * width)
    label = _code(line.label) if line.name else escape(line.label)
    aside = f" ({escape(line.aside)})" if line.aside else ""
    return (f"{label}{aside}", *map(_entry, line.entries))


def _entry(entry: Entry) -> str:
    text = _code(entry.text) if entry.name else escape(entry.text)
    if entry.detected or entry.tone == "bad":
        text = f"**{text}**"
    behind = (entry.aside, entry.published)
    return " ".join([text, *(f"({escape(each)})" for each in behind if each)])


def _code(name: str) -> str:
    return escape(name) if any(mark in name for mark in "`|\n\\") else f"`{name}`"
