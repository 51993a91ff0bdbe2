"""Tables of a study in LaTeX and Markdown: escaped, complete, and balanced, for there is no TeX."""

import re

import pytest

from faultpath.decisions.tables import Entry, Line, Table
from faultpath.decisions.tables.latex import booktabs
from faultpath.decisions.tables.markdown import block as markdown

STRANGE = r"100% of a_b & c#d {$x^2$} ~ \end{tabular} <b> [1] | *"

SMALL = Table(
    name="table-9",
    title="A title",
    columns=("e = −0.1", "Δ (m/s²)"),
    lines=(
        Line(label="Heading (pp)"),
        Line(
            label="[row]",
            entries=(Entry(text="+57.3", published="+49.7", detected=True), Entry(text="")),
        ),
        Line(label="Another", entries=(Entry(text="–", published="no crossing"), Entry(text="4"))),
        Line(label="Ours alone", entries=(Entry(text="[−1.0, 2.0]"), Entry(text="p* 3 %"))),
    ),
    notes=("First note.", "Second_note."),
)
ODD = Table(
    name="odd",
    title=STRANGE,
    columns=(STRANGE,),
    lines=(
        Line(label=STRANGE),
        Line(label=STRANGE, entries=(Entry(text=STRANGE, published=STRANGE, detected=True),)),
    ),
    notes=(STRANGE,),
)


def _unescaped(tex: str) -> str:
    """Drop what stands for a character of its own, so that what is left is TeX's."""
    return re.sub(r"\\[{}&%$#_]", "", tex)


def _check_balance(tex: str) -> None:
    plain = _unescaped(tex)
    depth = 0
    for character in plain:
        depth += {"{": 1, "}": -1}.get(character, 0)
        assert depth >= 0
    assert depth == 0
    assert plain.count("$") % 2 == 0
    assert "%" not in plain
    assert "#" not in plain
    stack: list[str] = []
    for what, environment in re.findall(r"\\(begin|end)\{([\w*]+)\}", plain):
        if what == "begin":
            stack.append(environment)
        else:
            assert stack.pop() == environment
    assert not stack


def _rows(tex: str) -> list[str]:
    body = tex.partition(r"\toprule")[2].partition(r"\bottomrule")[0]
    return [row for row in body.splitlines() if row.endswith(r"\\")]


@pytest.mark.parametrize("table", [SMALL, ODD], ids=lambda table: table.name)
def test_latex_is_balanced_and_every_row_has_every_column(table: Table) -> None:
    tex = booktabs(table)
    _check_balance(tex)
    assert tex.isascii()
    assert "[U+" not in tex
    for row in _rows(tex):
        plain = _unescaped(row)
        if r"\multicolumn" in plain:
            assert rf"\multicolumn{{{len(table.columns) + 1}}}" in plain
        else:
            assert plain.count("&") == len(table.columns)
    assert rf"{{@{{}}l{'c' * len(table.columns)}@{{}}}}" in tex


def test_no_text_ends_an_environment_or_starts_a_comment() -> None:
    tex = booktabs(ODD)
    assert tex.count(r"\end{tabular}") == 1
    assert r"\textbackslash{}end\{tabular\}" in tex
    assert r"100\% of a\_b \& c\#d" in tex


def test_markdown_puts_the_papers_figure_in_parentheses() -> None:
    rows = [row for row in markdown(SMALL).splitlines() if row.startswith("|")]
    assert rows[0] == "| | e = −0.1 | Δ (m/s²) |"
    assert rows[2:] == [
        "| *Heading (pp)* |  |  |",
        r"| \[row\] | **+57.3** (+49.7) |  |",
        "| Another | – (no crossing) | 4 |",
        r"| Ours alone | \[−1.0, 2.0\] | p\* 3 % |",
    ]


def test_markdown_takes_text_literally() -> None:
    text = markdown(ODD)
    assert "<b>" not in text
    assert r"a\_b" in text
    assert r"\[1\] \| \*" in text
