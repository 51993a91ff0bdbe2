"""A result as a terminal shows it, and any table."""

from collections.abc import Iterable
from textwrap import fill

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.padding import Padding
from rich.table import Table as Drawn
from rich.text import Text

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.report.audit_tables import DIFFERENCE, by_condition, by_quantity, chosen_metric
from faultpath.report.sentences import wording, words
from faultpath.report.sentences.answers import answers, would_change
from faultpath.report.sentences.phrases import (
    for_trainings,
    in_trials_that_ran,
    not_standing,
    stopping,
)
from faultpath.report.tables import Entry, Table, Tone

STYLES: dict[Tone, str] = {"": "", "good": "green", "bad": "bold red", "faint": "dim"}
"""How tones look."""
_ROOMY = 5
"""Columns that leave room on a terminal of 80 characters to stand two blanks apart."""
_EFFECTS = (*DIFFERENCE, "holm", "scenes", "void", "break-even")


def decision(result: AuditResult, details: bool = False) -> RenderableType:
    """Return the result of an audit as text and tables: headline, success, effects, findings.

    `details` adds every sentence of the result, and what would change it.
    """
    question, text = result.question, words(result)
    missing = any(effect.void for effect in result.effects)
    names = [name for name in _EFFECTS if missing or name != "void"]
    success = by_quantity(result, ("baseline", "repair"))
    effects = by_condition(result, names, f"{question.repair} minus {question.baseline}")
    parts: list[RenderableType] = [Text(text.headline, style="bold")]
    parts += _list("Found in the run", text.findings, "bold red")
    about: list[RenderableType] = []
    if fault := wording.faults(result.facts):
        about += [Text(f"Fault: {fault}.", style="dim")]
    if how := stopping(result):
        about += [Text(f"A sequential audit: {how}.")]
    parts += [Text(""), *about] if about and text.findings else about
    parts += [Text(""), Parted(success), Text(""), Parted(effects)]
    if result.break_even and not result.invalid:
        explained = (
            "Break-even, % of trials with the fault: the estimate where there is one, and in "
            "brackets where neither is shown to be ahead; none: one is ahead everywhere; any: no "
            "bound could be shown."
        )
        parts += [Text(explained, style="dim")]
    plain = answers(result)
    if not details and (follows := plain.get("Left open" if result.invalid else "What follows")):
        parts += [Text(""), Text(follows)]
    # Among all sentences these stand anyway.
    caveats = (*not_standing(result), *in_trials_that_ran(result), *for_trainings(result))
    for sentence in () if details else caveats:
        parts += [Text(""), Text(sentence)]
    table = chosen_metric(result)
    if table is not None:
        parts += [Text(""), Parted(table)]
    if details:
        if any(effect.mcnemar_p is not None for effect in result.effects):
            parts += [Text(""), Parted(by_condition(result, ("p", "mcnemar", "holm")))]
        parts += [Text(""), *map(Text, text.sentences)]
        parts += _list("What would change this", tuple(would_change(result)), "bold")
    return Group(*parts)


def conclusion(result: MapResult | ScanResult, tables: Iterable[Table]) -> RenderableType:
    """Return headline, sentences, findings and tables of a map or a scan."""
    text = words(result)
    parts: list[RenderableType] = [Text(text.headline, style="bold")]
    parts += _list("Found in the run", text.findings, "bold red")
    parts += [Text(""), *map(Text, text.sentences)]
    for table in tables:
        parts += [Text(""), Parted(table), *map(Text, table.notes)]
    return Group(*parts)


def _list(title: str, items: tuple[str, ...], style: str) -> list[RenderableType]:
    if not items:
        return []
    points = (Padding(Text(f"- {item}"), (0, 0, 0, 2)) for item in items)
    return [Text(""), Text(title, style=style), *points]


def drawn(
    table: Table, *, one_line: bool = False, apart: tuple[int, int, int, int] | None = None
) -> Drawn:
    """Return a table for rich, without its notes.

    `one_line`: numbers are never folded, and words are cut at the edge of the terminal. `apart`:
    how far entries stand from each other; by itself that follows from how many there are.
    """
    title = Text(table.title) if table.title else None
    drawing = Drawn(
        title=title, title_justify="left", box=None, pad_edge=False, padding=apart or _apart(table)
    )
    # Columns of words give way first, else the labels, but never below their longest word.
    drawing.add_column(
        Text(table.corner),
        no_wrap=one_line and bool(table.words),
        min_width=_longest(word for line in table.lines for word in line.label.split()),
    )
    for index, column in enumerate(table.columns):
        words = column in table.words
        head = column if words or not one_line else _folded(column, index, table)
        side = "left" if words else "right"
        drawing.add_column(Text(head), justify=side, no_wrap=one_line and not words)
    between = "\n" if _tall(table) else " "
    for row in table.lines:
        label = Text(row.label, "" if row.entries else "italic")
        if row.aside:
            label.append(f"{between}({row.aside})", "dim")
        cells = [_text(entry) for entry in row.entries]
        for cell in cells:
            cell.no_wrap, cell.overflow = one_line, "ellipsis" if one_line else None
        drawing.add_row(label, *cells)
    return drawing


class Parted:
    """A table whose numbers are never folded: columns that find no room stand in a further one."""

    def __init__(self, table: Table) -> None:
        self._table = table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the table, or as many as its columns need, each with the labels of the lines."""
        rest = self._table
        while True:
            count = max(1, _columns_within(options.max_width, rest))
            # As far apart as was reckoned with, or what has room would be cut after all.
            yield drawn(_columns(rest, slice(count)), one_line=True, apart=_apart(rest))
            if count >= len(rest.columns):
                return
            rest = _columns(rest, slice(count, None)).model_copy(update={"title": ""})
            yield ""


def _columns(table: Table, which: slice) -> Table:
    lines = tuple(line.model_copy(update={"entries": line.entries[which]}) for line in table.lines)
    return table.model_copy(update={"columns": table.columns[which], "lines": lines})


def _columns_within(width: int, table: Table) -> int:
    """Count the first columns that stand unfolded within `width`, beside the narrowest labels."""
    used = _longest(word for line in table.lines for word in line.label.split())
    for index, column in enumerate(table.columns):
        # A heading of words is never folded, so it counts whole.
        head = column if column in table.words else _folded(column, index, table)
        texts = [_text(line.entries[index]).plain for line in table.lines if line.entries]
        used += _apart(table)[1] + _longest(
            line for text in (head, *texts) for line in text.splitlines()
        )
        if used > width:
            return index
    return len(table.columns)


def _folded(column: str, index: int, table: Table) -> str:
    """Break a heading where it is wider than what stands below it."""
    below = _longest(_text(line.entries[index]).plain for line in table.lines if line.entries)
    return fill(column, max(below, _longest(column.split())), break_long_words=False)


def _longest(texts: Iterable[str]) -> int:
    return max(map(len, texts), default=1)


def _tall(table: Table) -> bool:
    return any("\n" in entry.text for line in table.lines for entry in line.entries)


def _apart(table: Table) -> tuple[int, int, int, int]:
    return (0, 1 if len(table.columns) > _ROOMY else 2, 1 if _tall(table) else 0, 0)


def _text(entry: Entry) -> Text:
    text = Text(entry.text, "bold" if entry.detected else STYLES[entry.tone])
    if entry.aside:
        text.append(f" ({entry.aside})", "not bold dim")
    return text.append(f"\n({entry.published})", "dim") if entry.published else text
