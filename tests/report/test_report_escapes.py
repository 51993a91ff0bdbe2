"""Names in Markdown, HTML and SVG are shown, and are nothing else."""

import re
from xml.etree import ElementTree

import pytest
from faultpath_paper.report.terminal import ledger_markdown
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from reproduction_toys import ledger

from faultpath.report import escapes
from faultpath.report.audit_tables import markdown_table
from faultpath.report.frame import render
from faultpath.report.inputs import ReportInput
from faultpath.report.svg import Svg
from faultpath.report.tables import Entry, Line, Table
from faultpath.report.tables import markdown_block as table_markdown

NASTY = '<script>alert("x")</script> & 100 % of _it_'
PARSER = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"])
NAMES = (
    NASTY,
    "cost $x$ and $$y$$",
    "\\$z$ `code` $`a`$",
    "&lt;b&gt; &amp; &#36;x&#36;",
    "<img src=x onerror=alert(1)>",
    "![a](javascript:alert(1)) [b](http://x)",
    "<http://x.example>",
    "a | b || c",
    "# head",
    "- list",
    "+ list",
    "12. list",
    "1) list",
    "===",
    "---",
    "    code",
    "~~gone~~ **bold** __bold__ *it* _it_",
    "one\n\n- two\r\n<b>",
    "> quote",
    "``` fence",
)


MARKUP = {
    *("html_inline", "html_block", "link_open", "image", "code_inline", "heading_open", "fence"),
    *("code_block", "hr", "blockquote_open", "s_open", "ordered_list_open"),
}


def _shown(markdown: str) -> str:
    """Return the text of the only paragraph that this is, after checking that it is plain text."""
    opening, inline, closing = PARSER.parse(markdown)
    assert (opening.type, closing.type) == ("paragraph_open", "paragraph_close")
    assert {child.type for child in inline.children} <= {"text", "text_special"}
    return "".join(child.content for child in inline.children)


def _line(text: str) -> str:
    return re.sub(r"[\t\n\r]", " ", text).strip(" ")


@pytest.mark.parametrize("name", NAMES)
def test_markdown_shows_a_name_as_it_is(name: str) -> None:
    assert _shown(escapes.markdown(name)) == _line(name)


@settings(max_examples=40)
@given(st.text(st.characters(codec="utf-8", max_codepoint=0x2FF), min_size=1))
def test_markdown_shows_any_text_as_it_is(name: str) -> None:
    seen = escapes.visible(_line(name)).strip(" ")
    if seen.strip():
        assert _shown(escapes.markdown(name)).split() == seen.split()


@pytest.mark.parametrize("name", NAMES)
def test_markdown_tables_hold_no_markup_of_a_user(name: str, one_seed: ReportInput) -> None:
    record = one_seed.record
    named = {"library": name, "system": name}
    conditions = tuple(
        condition.model_copy(update={"title": name}) for condition in record.conditions
    )
    question = record.question.model_copy(update={"fault": name})
    facts = record.facts.model_copy(update=named)
    told = {"question": question, "facts": facts, "conditions": conditions}
    lines = (Line(label=name, entries=(Entry(text=name, published=name),)), Line(label=name))
    table = Table(name="table-9", title=name, columns=(name,), lines=lines, notes=(name,))
    claimed = ledger().model_copy(update={"library": name})
    for text in (
        markdown_table(record.model_copy(update=told)),
        table_markdown(table),
        ledger_markdown(claimed, "paper"),
    ):
        kinds = {
            child.type
            for token in PARSER.parse(text)
            for child in (token, *(token.children or ()))
            if child.type != "text_special"
        }
        assert not kinds & MARKUP
        assert not re.search(r"(?<!\\)(\\\\)*\$", text)
        rows = [line for line in text.splitlines() if line.startswith("|")]
        assert len({len(re.findall(r"(?<!\\)\|", row)) for row in rows}) == 1


UNSEEN = "a\0b\x1bc\x85d\u202ee\u2066f\ud800g\u2028h"
SEEN = "a[U+0000]b[U+001B]c[U+0085]d[U+202E]e[U+2066]f[U+D800]g[U+2028]h"


def test_what_cannot_be_seen_is_shown_by_its_number(one_seed: ReportInput) -> None:
    assert escapes.visible(UNSEEN) == SEEN
    assert _shown(escapes.markdown(UNSEEN)) == SEEN
    assert escapes.html(f"<{UNSEEN}>") == f"&lt;{SEEN}&gt;"
    svg = Svg(10, 10, UNSEEN, UNSEEN)
    svg.text(0, 0, UNSEEN, tip=UNSEEN)
    svg.circle((0, 0), 1, UNSEEN, tip=UNSEEN)
    root = ElementTree.fromstring(svg.render(standalone=True))
    assert "".join(root.itertext()).count(SEEN) == 5


def test_a_template_without_its_values_is_refused() -> None:
    with pytest.raises(Exception, match="undefined"):
        render("report.html.j2", (), ())
