"""The page of a reproduction: whole, with the numbers given."""

import re

import pytest
from faultpath_paper.report import words
from faultpath_paper.report.page import reproduction_page, sweep_plot
from faultpath_paper.report.terminal import ledger_markdown, ledger_view
from page_reader import Page, printed
from reproduction_toys import NASTY, ledger, reproduction, sweep, tables

from faultpath.report.inputs import ReportInput
from faultpath.report.tables import Entry, Line, Table

CENTRAL = Table(
    columns=("Isolated", "Shared"),
    lines=(Line(label="Here", entries=(Entry(text="+5.0", detected=True), Entry(text="−4.0"))),),
    notes=("The reversal is decided here.",),
)


@pytest.fixture(scope="module")
def html(one_seed: ReportInput) -> str:
    central = ("C26 is open here", "Here is why.", CENTRAL)
    return reproduction_page(reproduction(), one_seed.provenance, central)


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def test_every_claim_opens_to_its_parts_and_evidence(html: str, page: Page) -> None:
    for claim in ledger().claims:
        row = html.partition(f'id="{claim.id}"')[2].partition("</details>")[0]
        assert row.count('class="chip ') == 1 + len(claim.parts)
    for said in (
        "p < 0.001 (sign test on scene means)",
        "smallest detectable difference 12.5 pp",
        "only one succeeds, first:second by seed, 51:0/51:1/49:1",
        "the run holds no wm-u",
        "Coupled e=−0.1 lowers success by ≥ 20 pp",
    ):
        assert said in page.text
    assert re.search(r"\+57\.3 pp \[48\.3, 66\.3\]", page.text)
    assert "smallest detectable difference 0.20" not in page.text  # a ratio's nothing is 1, not 0


def test_tables_set_each_figure_beside_the_papers(html: str, page: Page) -> None:
    assert '<span class="ours found">+57.3</span>' in html
    assert all(f'id="{table.name}"' in html for table in tables())
    assert "100 throughout" in page.text


def test_sweep_draws_every_point_and_band() -> None:
    drawn = sweep_plot(sweep())
    assert drawn.count('class="spot') == 2 + 10  # the key's, and the points
    assert drawn.count('class="spread') == 2
    assert NASTY not in drawn
    assert "<svg" in sweep_plot(sweep().model_copy(update={"series": ()}))


def test_terminal_and_markdown_cut_nothing_of_a_claim() -> None:
    text = printed(ledger_view(ledger(), "paper"), 72)
    lines = text.splitlines()
    for claim in ledger().claims:
        (line,) = (line for line in lines if line.startswith(claim.id))
        assert line.split()[2] == words.SHOWN[claim.verdict]
        assert words.typeset(claim.claim) in " ".join(text.split())
    rows = [r for r in ledger_markdown(ledger(), "paper").splitlines() if r.startswith("|")]
    assert len(rows) == 2 + len(ledger().claims)
    assert len({len(re.findall(r"(?<!\\)\|", row)) for row in rows}) == 1
    assert "<script>" not in "".join(rows)


def test_a_quick_run_decides_nothing_and_says_where_verdicts_stand() -> None:
    quick = reproduction().model_copy(update={"profile": "quick"})
    text = printed(ledger_view(ledger(), "quick"), 200)
    page = Page(reproduction_page(quick, None, None)).text
    for said in (text, ledger_markdown(ledger(), "quick"), page):
        assert "tests the pipeline" in said
        assert not re.search(r"confirm \d|refute \d|\d confirmed, ✕", said)
    for said in (text, page):
        assert "docs/reproduction.md" in said
