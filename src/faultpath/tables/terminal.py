"""Tables on the terminal: the paper's figure stands in parentheses below ours."""

from typing import TYPE_CHECKING

from faultpath.tables.model import Entry, Line, Table

if TYPE_CHECKING:
    from rich.table import Table as Drawn
    from rich.text import Text

_TONES = {"": "", "good": "green", "bad": "bold red", "faint": "dim"}


def drawn(table: Table, *, one_line: bool = False) -> "Drawn":
    """Return a table for rich, without its notes.

    `one_line`: numbers are never folded, and words are cut at the edge of the terminal.
    """
    from rich.table import Table as Drawn
    from rich.text import Text

    title = Text(table.title) if table.title else None
    tall = any("\n" in entry.text for line in table.lines for entry in line.entries)
    apart = (0, 2, 1 if tall else 0, 0)
    made = Drawn(title=title, title_justify="left", box=None, pad_edge=False, padding=apart)
    # Columns of words give way first, else the labels.
    made.add_column(Text(table.corner), no_wrap=one_line and bool(table.words))
    for column in table.columns:
        words = column in table.words
        side = "left" if words else "right"
        made.add_column(Text(column), justify=side, no_wrap=one_line and not words)
    for line in table.lines:
        cells = [_text(entry) for entry in line.entries]
        for cell in cells:
            cell.no_wrap, cell.overflow = one_line, "ellipsis" if one_line else None
        made.add_row(_label(line, below=tall), *cells)
    return made


def _label(line: Line, *, below: bool) -> "Text":
    from rich.text import Text

    text = Text(line.label, "" if line.entries else "italic")
    parted = "\n" if below else " "
    return text.append(f"{parted}({line.aside})", "dim") if line.aside else text


def _text(entry: Entry) -> "Text":
    from rich.text import Text

    text = Text(entry.text, "bold" if entry.detected else _TONES[entry.tone])
    if entry.aside:
        text.append(f" ({entry.aside})", "not bold dim")
    return text.append(f"\n({entry.published})", "dim") if entry.published else text
