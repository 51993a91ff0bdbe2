"""Tables of a study in Markdown: escaped and complete."""

from faultpath.decisions.tables import Entry, Line, Table
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
