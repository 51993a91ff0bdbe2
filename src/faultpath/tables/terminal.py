"""Tables on the terminal: the paper's figure stands in parentheses below ours."""

from textwrap import fill
from typing import TYPE_CHECKING

from faultpath.tables.model import Entry, Line, Table, Tone

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.table import Table as Drawn
    from rich.text import Text

STYLES: dict[Tone, str] = {"": "", "good": "green", "bad": "bold red", "faint": "dim"}
"""How tones look."""
_ROOMY = 5
"""Columns that leave room on a terminal of 80 characters to stand two blanks apart."""


def drawn(table: Table, *, one_line: bool = False) -> "Drawn":
    """Return a table for rich, without its notes.

    `one_line`: numbers are never folded, and words are cut at the edge of the terminal.
    """
    from rich.table import Table as Drawn
    from rich.text import Text

    title = Text(table.title) if table.title else None
    tall = any("\n" in entry.text for line in table.lines for entry in line.entries)
    apart = (0, 1 if len(table.columns) > _ROOMY else 2, 1 if tall else 0, 0)
    made = Drawn(title=title, title_justify="left", box=None, pad_edge=False, padding=apart)
    # Columns of words give way first, else the labels, but never below their longest word.
    made.add_column(
        Text(table.corner),
        no_wrap=one_line and bool(table.words),
        min_width=_longest(word for line in table.lines for word in line.label.split()),
    )
    for index, column in enumerate(table.columns):
        words = column in table.words
        head = column if words or not one_line else _folded(column, index, table)
        side = "left" if words else "right"
        made.add_column(Text(head), justify=side, no_wrap=one_line and not words)
    for line in table.lines:
        cells = [_text(entry) for entry in line.entries]
        for cell in cells:
            cell.no_wrap, cell.overflow = one_line, "ellipsis" if one_line else None
        made.add_row(_label(line, below=tall), *cells)
    return made


def _longest(texts: "Iterable[str]") -> int:
    return max(map(len, texts), default=1)


def _folded(column: str, index: int, table: Table) -> str:
    """Break a heading where it is wider than what stands below it."""
    below = _longest(_text(line.entries[index]).plain for line in table.lines if line.entries)
    return fill(column, max(below, _longest(column.split())), break_long_words=False)


def _label(line: Line, *, below: bool) -> "Text":
    from rich.text import Text

    text = Text(line.label, "" if line.entries else "italic")
    parted = "\n" if below else " "
    return text.append(f"{parted}({line.aside})", "dim") if line.aside else text


def _text(entry: Entry) -> "Text":
    from rich.text import Text

    text = Text(entry.text, "bold" if entry.detected else STYLES[entry.tone])
    if entry.aside:
        text.append(f" ({entry.aside})", "not bold dim")
    return text.append(f"\n({entry.published})", "dim") if entry.published else text
