"""One table in three renderers: each shows every text literally and marks what is marked."""

import io

from rich.console import Console

from faultpath.analyses.tables import Entry, Line, Table, line
from faultpath.analyses.tables.html import html
from faultpath.analyses.tables.markdown import block, grid
from faultpath.analyses.tables.terminal import drawn

TABLE = Table(
    title="What came out",
    corner="Model",
    columns=("Rate, %", "What it is"),
    words=("What it is",),
    lines=(
        line("With wind"),
        line("wm-a", Entry(text="70.3", published="69"), "a model", name=True, aside="zero wind"),
        line("dob", Entry(text="+5.0", detected=True, aside="floor"), "an observer"),
        line("gru", Entry(text="3", tone="bad"), Entry(text="ab12", name=True)),
    ),
)
STRANGE = r"100% of a_b & c#d {$x^2$} ~ \end{tabular} <b> [1] | *"


def _terminal(table: Table, width: int = 100, **how: bool) -> str:
    console = Console(file=io.StringIO(), width=width, force_terminal=False)
    console.print(drawn(table, **how))
    return console.file.getvalue()  # type: ignore[attr-defined] - a StringIO


def test_markdown_marks_names_detections_and_alarms() -> None:
    assert grid(TABLE).splitlines() == [
        "| Model | Rate, % | What it is |",
        "| :-- | --: | :-- |",
        "| *With wind* |  |  |",
        "| `wm-a` (zero wind) | 70.3 (69) | a model |",
        "| dob | **+5.0** (floor) | an observer |",
        "| gru | **3** | `ab12` |",
    ]


def test_markdown_takes_text_literally() -> None:
    entry = Entry(text=STRANGE, published=STRANGE, detected=True)
    lines = (Line(label=STRANGE), Line(label=STRANGE, entries=(entry,)))
    odd = Table(name="odd", title=STRANGE, columns=(STRANGE,), lines=lines, notes=(STRANGE,))
    text = block(odd)
    assert "<b>" not in text
    assert r"a\_b" in text
    assert r"\[1\] \| \*" in text


def test_html_has_a_cell_for_every_column_and_escapes() -> None:
    text = html(TABLE.model_copy(update={"title": "<b>"}))
    assert "<caption>&lt;b&gt;</caption>" in text
    assert "<caption>" not in html(TABLE, caption=False)
    assert '<th scope="rowgroup" colspan="3"><span>With wind</span>' in text
    assert '<span class="ours found">+5.0 <small>(floor)</small></span>' in text
    assert '<td class="alarm"><span class="ours">3</span></td>' in text
    short = Table(columns=("a", "b"), lines=(line("x", "<1>"),))
    assert '<td><span class="ours">&lt;1&gt;</span></td><td></td>' in html(short)


def test_terminal_shows_everything_and_takes_it_literally() -> None:
    text = _terminal(TABLE.model_copy(update={"corner": "[red]Model[/]"}))
    for words in ("[red]Model[/]", "What came out", "wm-a (zero wind)", "(69)", "+5.0 (floor)"):
        assert words in text


def test_a_narrow_terminal_cuts_words_but_no_number() -> None:
    claim = line("C01", "+57.3 pp [48.3, 66.3]", "word " * 40)
    columns = ("Estimate", "Words")
    long = Table(corner="Claim", columns=columns, words=("Words",), lines=(claim,))
    _, shown = _terminal(long, width=50, one_line=True).splitlines()
    assert shown.startswith("C01    +57.3 pp [48.3, 66.3]  word")
    assert shown.rstrip().endswith("…")
