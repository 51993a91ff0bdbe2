"""One table in three renderers: each shows every text literally and marks what is marked."""

import pytest
from page_reader import printed

from faultpath.report.tables import Entry, Line, Table, html, line, markdown_block, markdown_grid
from faultpath.report.terminal import drawn

TABLE = Table(
    title="What came out",
    corner="Model",
    columns=("Rate, %", "What it is"),
    words=("What it is",),
    lines=(
        line("With wind"),
        line("wm-a", Entry(text="70.3", published="69"), "a model", aside="zero wind"),
        line("dob", Entry(text="+5.0", detected=True, aside="floor"), "an observer"),
        line("gru", Entry(text="3", tone="bad"), "ab12"),
    ),
)
STRANGE = r"100% of a_b & c#d {$x^2$} ~ \end{tabular} <b> [1] | *"


def _terminal(table: Table, width: int = 100, **how: bool) -> str:
    return printed(drawn(table, **how), width)


RENDERERS = {"markdown": markdown_grid, "html": html, "terminal": _terminal}


@pytest.mark.parametrize("name", RENDERERS)
def test_a_table_is_shown_as_it_was_approved(name: str, approved) -> None:
    shown = RENDERERS[name](TABLE.model_copy(update={"corner": "[red]Model[/]"}))
    approved(name, "\n".join(line.rstrip() for line in str(shown).splitlines()))


def test_names_are_shown_literally() -> None:
    entry = Entry(text=STRANGE, published=STRANGE, detected=True)
    lines = (Line(label=STRANGE), Line(label=STRANGE, entries=(entry,)))
    odd = Table(name="odd", title=STRANGE, columns=(STRANGE,), lines=lines, notes=(STRANGE,))
    assert "<b>" not in markdown_block(odd)
    assert r"a\_b" in markdown_block(odd)
    assert r"\[1\] \| \*" in markdown_block(odd)
    assert "<b>" not in html(odd)
    assert "<caption>" not in html(TABLE, caption=False)
    assert html(Table(columns=("a", "b"), lines=(line("x", "1"),))).endswith(
        "</td><td></td></tr>\n</tbody>\n</table>"
    )


def test_words_may_break_in_a_page_but_no_number_from_its_unit() -> None:
    columns = ("Estimate", "Ahead")
    table = Table(columns=columns, words=("Ahead",), lines=(line("x", "5.0", "from 75 % on"),))
    page = html(table)
    assert '<th scope="col">Estimate</th><th scope="col" class="word">Ahead</th>' in page
    assert '<td class="word"><span class="ours">from 75\N{NO-BREAK SPACE}% on</span></td>' in page


def test_a_narrow_terminal_cuts_words_but_no_number() -> None:
    claim = line("C01", "+57.3 pp [48.3, 66.3]", "word " * 40)
    columns = ("Estimate", "Words")
    long = Table(corner="Claim", columns=columns, words=("Words",), lines=(claim,))
    _, shown = _terminal(long, width=50, one_line=True).splitlines()
    assert shown.startswith("C01    +57.3 pp [48.3, 66.3]  word")
    assert shown.rstrip().endswith("…")
