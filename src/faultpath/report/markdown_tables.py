"""Tables of a study as Markdown: our figure, and the paper's in parentheses behind it."""

from faultpath.record import Entry, Line, Table
from faultpath.report import escapes
from faultpath.report.booktabs import LEGEND


def markdown(table: Table) -> str:
    """Return title, table and notes, each a block of its own."""
    width = len(table.columns)
    rows = [
        f"| | {' | '.join(map(escapes.markdown, table.columns))} |",
        f"| :-- | {' | '.join(['--:'] * width)} |",
        *(_row(line, width) for line in table.lines),
    ]
    notes = [f"- {escapes.markdown(note)}" for note in (LEGEND, *table.notes)]
    return "\n".join([f"**{escapes.markdown(table.title)}**", "", *rows, "", *notes, ""])


def _row(line: Line, width: int) -> str:
    label = escapes.markdown(line.label) if line.entries else f"*{escapes.markdown(line.label)}*"
    cells = map(_cell, line.entries) if line.entries else [""] * width
    return f"| {label} | {' | '.join(cells)} |"


def _cell(entry: Entry) -> str:
    ours = escapes.markdown(entry.text)
    if entry.detected:
        ours = f"**{ours}**"
    return f"{ours} ({escapes.markdown(entry.published)})" if entry.published else ours
