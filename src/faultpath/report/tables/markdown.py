"""Tables as Markdown: the paper's figure stands in parentheses behind ours."""

from collections.abc import Iterable

from faultpath.report.tables.escapes import markdown as escape
from faultpath.report.tables.model import Entry, Table


def block(table: Table) -> str:
    """Return title, table and notes, each a block of its own."""
    notes = [f"- {escape(note)}" for note in (*table.legend(), *table.notes)]
    return "\n".join([f"**{escape(table.title)}**", "", grid(table), "", *notes, ""])


def blocks(tables: Iterable[Table]) -> str:
    """Return tables one below the other."""
    return "\n\n".join(map(block, tables))


def grid(table: Table) -> str:
    """Return the lines of the table alone."""
    rows = [
        [escape(text) for text in (table.corner, *table.columns)],
        [":--", *(":--" if column in table.words else "--:" for column in table.columns)],
    ]
    for line in table.lines:
        if not line.entries:
            rows.append([f"*{escape(line.label)}*", *[""] * len(table.columns)])
            continue
        label = _code(line.label) if line.name else escape(line.label)
        label += f" ({escape(line.aside)})" if line.aside else ""
        rows.append([label, *map(_entry, line.entries)])
    return "\n".join(f"| {f'{row[0]} ' if row[0] else ''}| {' | '.join(row[1:])} |" for row in rows)


def _entry(entry: Entry) -> str:
    text = _code(entry.text) if entry.name else escape(entry.text)
    if entry.detected or entry.tone == "bad":
        text = f"**{text}**"
    behind = (entry.aside, entry.published)
    return " ".join([text, *(f"({escape(part)})" for part in behind if part)])


def _code(name: str) -> str:
    return escape(name) if any(mark in name for mark in "`|\n\\") else f"`{name}`"
