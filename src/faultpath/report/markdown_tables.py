"""Tables of a study as Markdown: our figure, and the paper's in parentheses behind it."""

from faultpath.record import Entry, Line, Table

LEGEND = "In parentheses: the paper's figures. Bold: a detected difference."

_ESCAPES = str.maketrans(
    {c: f"\\{c}" for c in r"\`*_[]|#"} | {"<": "&lt;", ">": "&gt;", "\n": " ", "\r": " "}
)


def markdown(table: Table) -> str:
    """Return title, table and notes, each a block of its own."""
    width = len(table.columns)
    rows = [
        f"| | {' | '.join(map(escaped, table.columns))} |",
        f"| :-- | {' | '.join(['--:'] * width)} |",
        *(_row(line, width) for line in table.lines),
    ]
    notes = [f"- {escaped(note)}" for note in (LEGEND, *table.notes)]
    return "\n".join([f"**{escaped(table.title)}**", "", *rows, "", *notes, ""])


def escaped(text: str) -> str:
    """Return text that Markdown shows as it is."""
    return text.translate(_ESCAPES)


def _row(line: Line, width: int) -> str:
    label = escaped(line.label) if line.entries else f"*{escaped(line.label)}*"
    cells = map(_cell, line.entries) if line.entries else [""] * width
    return f"| {label} | {' | '.join(cells)} |"


def _cell(entry: Entry) -> str:
    ours = escaped(entry.text)
    if entry.detected:
        ours = f"**{ours}**"
    return f"{ours} ({escaped(entry.published)})" if entry.published else ours
