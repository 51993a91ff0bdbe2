"""The page of a reproduction: whole, closed to the network, escaped, with the numbers given."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import pytest
from reproduction_toys import NASTY, ledger, source, sweep, tables
from rich.console import Console

from faultpath.report.figures.gallery import scene_view
from faultpath.report.figures.sweep import sweep_plot
from faultpath.report.inputs import ReportInput, Traces
from faultpath.report.reproduction import words
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.intervals import Scale, Shown, interval_plot
from faultpath.report.reproduction.page import reproduction_page
from faultpath.report.reproduction.terminal import ledger_markdown, ledger_view
from faultpath.report.svg import number
from faultpath.tables import Entry, Line, Table
from faultpath.trials import FloorPlan, OutcomeTable, Prism


class Page(HTMLParser):
    """Tags with attributes, cells of tables, and the text that a reader sees."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self._words: list[str] = []
        self._hidden = 0
        self._in_cell = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._hidden += tag in ("script", "style", "title", "desc")
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self._in_cell = True

    def handle_endtag(self, tag: str) -> None:
        self._hidden -= tag in ("script", "style", "title", "desc")
        if tag in ("td", "th"):
            self._in_cell = False

    def handle_data(self, data: str) -> None:
        if self._in_cell:
            self.rows[-1][-1] += data.strip()
        if not self._hidden:
            self._words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self._words))


@pytest.fixture(scope="module")
def toy(one_seed: ReportInput) -> ReproductionInput:
    return source(one_seed)


@pytest.fixture(scope="module")
def html(toy: ReproductionInput) -> str:
    return reproduction_page(toy)


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def test_page_loads_nothing(html: str, page: Page) -> None:
    for _, attributes in page.tags:
        assert attributes.get("src") is None
        assert (attributes.get("href") or "#").startswith(("#", "data:,"))
    assert set(re.findall(r"https?://[^\s\"'<>)]+", html)) <= {"http://www.w3.org/2000/svg"}
    assert "@import" not in html


def test_names_are_escaped(html: str, page: Page) -> None:
    assert "<script>alert" not in html
    assert html.count("&lt;script&gt;alert") > 10
    assert [tag for tag, _ in page.tags].count("script") == 2


def test_page_is_the_same_every_time_and_small(toy: ReproductionInput, html: str) -> None:
    assert reproduction_page(toy) == html
    assert len(html.encode()) < 1_000_000


def test_page_at_full_size_stays_small(toy: ReproductionInput) -> None:
    found, claims = toy.reproduction, toy.reproduction.ledger.claims
    many = tuple(
        claims[i % 3].model_copy(update={"id": f"C{i + 1:02d}", "parts": 6 * claims[i % 3].parts})
        for i in range(40)
    )
    lines = 20 * found.tables[0].lines
    wide = tuple(
        found.tables[0].model_copy(update={"name": f"table-{i}", "lines": lines}) for i in range(25)
    )
    update = {"ledger": found.ledger.model_copy(update={"claims": many}), "tables": wide}
    grown = replace(toy, reproduction=found.model_copy(update=update))
    html = reproduction_page(grown)
    assert len(html.encode()) < 4_000_000
    ids = [a["id"] for _, a in Page(html).tags if a.get("id")]
    assert len(ids) == len(set(ids))


def test_headline_comes_first_and_headings_do_not_skip(page: Page) -> None:
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))
    assert (
        "Of the paper’s 4 claims, our runs confirm 1, refute 1 and leave 2 undecided" in page.text
    )


def test_sections_stand_in_the_order_of_reading(page: Page) -> None:
    ids = [a["id"] for _, a in page.tags if a.get("id")]
    order = ["claims", "tables", "table-1", "table-6a", "figures", "figure-1", "figure-2"]
    order += ["figure-3", "flights", "method", "provenance"]
    assert [i for i in ids if i in order] == order


def test_ids_are_unique_and_links_lead_somewhere(page: Page) -> None:
    ids = [a["id"] for _, a in page.tags if a.get("id")]
    assert len(ids) == len(set(ids))
    links = [a["href"] for tag, a in page.tags if tag == "a" and a.get("href")]
    assert {link.removeprefix("#") for link in links if link} <= set(ids)


def test_every_claim_opens_to_its_parts_without_a_script(html: str, page: Page) -> None:
    opened = {a["id"]: a["class"] for tag, a in page.tags if tag == "details" and a.get("id")}
    for claim in ledger().claims:
        assert opened[claim.id] == f"claim {claim.verdict} {claim.kind} size-none"
        row = html.partition(f'id="{claim.id}"')[2].partition("</details>")[0]
        assert row.count('class="chip ') == 1 + len(claim.parts)
        assert row.count("<svg") == (claim.interval is not None) + sum(
            part.interval is not None for part in claim.parts
        )


def test_claims_stand_by_topic_with_thresholds_and_notes_stand_once(
    toy: ReproductionInput,
) -> None:
    found = toy.reproduction
    note = "Said of both."
    both = tuple(each.model_copy(update={"notes": (*each.notes, note)}) for each in found.tables)
    other = found.ledger.model_copy(update={"platform": "second"})
    told = replace(
        toy,
        reproduction=found.model_copy(update={"tables": both}),
        topics={"Gains": ("C01", "C03"), "None of these": ("C99",)},
        limits={"C01": ((30.0,), (5.0,)), "C02": ((1.0,),), "C03": ((0.0,), ())},
        beside=(other,),
    )
    html = reproduction_page(told)
    titles = re.findall(r'class="topic-title"[^>]*>([^<]*) <', html)
    assert titles == ["Gains", "Other"]
    order = re.findall(r'<details class="claim [^"]*" id="(C\d+)"', html)
    assert order == ["C01", "C03", "C02", "C04"]
    assert html.count('class="limit"') == 3  # C01 and its two parts; 1 of a ratio is no effect
    assert html.count('class="other-dot"') == 7  # of every interval there is
    text = re.sub(r"<[^>]*>", "", html)
    assert text.count(note) == 1
    assert html.count('href="#note-1"') == 2
    assert "4 of 4 claims have the same answer on both" in text
    assert all(f"<dt>{word}</dt>" in html for word in ("DCC", "DKI", "e", "e_R, e_P", "p*"))


def test_evidence_of_a_part_is_written_out(page: Page) -> None:
    assert "p < 0.001 (sign test on scene means)" in page.text
    assert "least detectable 12.5 pp" in page.text
    assert "only one succeeds in 51:0/51:1/49:1" in page.text
    assert "the run holds no wm-u" in page.text
    assert "+57.3 pp [48.3, 66.3]" in page.text
    assert "1.25× [1.10, 1.40]" in page.text
    assert "least detectable 0.20" not in page.text  # a ratio's nothing is 1, not 0
    assert "Coupled e=−0.1 lowers success by ≥ 20 pp" in page.text


def test_tables_set_each_figure_beside_the_papers(html: str, page: Page) -> None:
    assert ["WM-A", "70.3paper69", "–"] in page.rows
    assert ["WM-A+DCC", "+57.3paper+50", ""] in page.rows
    assert '<span class="ours found">+57.3</span>' in html
    assert html.count('class="ours found"') == 1
    for table in tables():
        assert f'id="{table.name}"' in html
    assert "100 throughout" in page.text


def test_failed_trials_are_said_above_the_claims(page: Page) -> None:
    text = page.text
    assert text.index("1 trial failed to run.") < text.index("C01")


def test_blocks_keep_every_line_in_order() -> None:
    lines = [Line(label=x, entries=(Entry(text="1"),)) for x in "abc"]
    table = Table(
        name="t",
        title="t",
        columns=("x",),
        lines=(lines[0], Line(label="one"), lines[1], lines[2], Line(label="two")),
    )
    cut = [(heading, [line.label for line in lines]) for heading, lines in table.blocks()]
    assert cut == [("", ["a"]), ("one", ["b", "c"]), ("two", [])]


def test_page_without_audit_flights_tables_and_provenance(toy: ReproductionInput) -> None:
    found = toy.reproduction.model_copy(
        update={"tables": (), "figures": (), "gallery": (), "configurations": ()}
    )
    bare = ReproductionInput(
        reproduction=found,
        provenance=None,
        interface=toy.interface,
        variants=(),
        decision=None,
        outcomes=OutcomeTable(()),
        traces=Traces({}, dt_s=0.05),
        plans={},
    )
    page = Page(reproduction_page(bare))
    ids = {a.get("id") for _, a in page.tags}
    assert {"C01", "provenance"} <= ids
    assert not {"figure-1", "flights", "tables", "figure-2", "viewer"} & ids


def test_trials_of_other_questions_are_left_out(toy: ReproductionInput, html: str) -> None:
    strangers = tuple(
        replace(row, path="elsewhere", variant=variant)
        for row in toy.outcomes.rows[:20]
        for variant in (row.variant, "stranger")
    )
    mixed = replace(toy, outcomes=OutcomeTable((*strangers, *toy.outcomes.rows)))
    assert reproduction_page(mixed) == html


def test_filled_dot_leaves_out_zero_and_band_shows_what_could_not_be_detected() -> None:
    scale = Scale.of("pp", [-20.0, 60.0])
    detected = interval_plot("a", Shown(5.0, (1.0, 9.0), least=30.0), scale)
    assert 'class="dot"' in detected
    assert "band" not in detected
    unclear = interval_plot("a", Shown(5.0, (-1.0, 9.0), least=10.0), scale)
    assert 'class="dot open"' in unclear
    assert f'class="band" x="{number(scale(-10.0))}"' in unclear
    assert "limit" not in unclear
    assert ">0 m<" in interval_plot("a", Shown(5.0, (1.0, 9.0)), scale, " m")


def test_of_ratios_one_is_no_effect_and_thresholds_are_drawn() -> None:
    scale = Scale.of("times", [0.5, 0.8, 4.0])
    lower = interval_plot("a", Shown(0.6, (0.5, 0.8), limits=(0.7,)), scale, "×")
    assert 'class="dot"' in lower
    assert f'x1="{number(scale(0.7))}"' in lower.partition('class="limit"')[2]
    assert scale(1.0) - scale(0.5) == pytest.approx(scale(2.0) - scale(1.0))
    assert ">1×<" in lower
    open_ = interval_plot("a", Shown(1.1, (0.8, 1.3), limits=(1.0,)), scale)
    assert 'class="dot open"' in open_
    assert "limit" not in open_


def test_sweep_draws_every_point_and_band() -> None:
    for narrow in (False, True):
        drawn = sweep_plot(sweep(), narrow)
        assert drawn.count('class="spot') == 2 + 10  # the key's, and the points
        assert drawn.count('class="spread') == 2
        assert NASTY not in drawn
    without = sweep().model_copy(update={"series": ()})
    assert "<svg" in sweep_plot(without)


@pytest.mark.parametrize("turn", [1, -1])
def test_view_shows_only_the_faces_turned_to_it(turn: int) -> None:
    corners = ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0))[::turn]
    plan = FloorPlan(
        low=(0.0, 0.0, 0.0),
        high=(4.0, 3.0, 2.0),
        prisms=(Prism(corners, 0.0, 1.0),),
        pillars=(),
        start=(0.5, 0.5, 1.0),
        goal=(3.5, 2.5, 1.0),
        title="",
    )
    drawn = scene_view(plan, "box")
    assert drawn.count('class="face top"') == 1
    assert drawn.count('class="face flat"') == 2


def test_terminal_cuts_nothing_of_a_claim() -> None:
    console = Console(width=72)
    with console.capture() as captured:
        console.print(ledger_view(ledger(), "paper"))
    lines = captured.get().splitlines()
    for claim in ledger().claims:
        (line,) = (line for line in lines if line.startswith(claim.id))
        assert line.split()[2] == claim.verdict
        assert words.typeset(claim.claim) in " ".join(captured.get().split())
    assert "✓ 1 confirmed, ✕ 1 refuted, ○ 2 undecided" in lines


def test_markdown_has_one_row_a_claim_and_escapes() -> None:
    rows = [
        line for line in ledger_markdown(ledger(), "paper").splitlines() if line.startswith("|")
    ]
    assert len(rows) == 2 + len(ledger().claims)
    assert len({len(re.findall(r"(?<!\\)\|", row)) for row in rows}) == 1
    assert "<script>" not in "".join(rows)
    assert "+57.3 pp \\[48.3, 66.3\\]" in rows[2]
    assert "What is claimed" in rows[0].split("|")[2]


CENTRAL = Table(
    columns=("Isolated", "Shared"),
    lines=(Line(label="Here", entries=(Entry(text="+5.0", detected=True), Entry(text="−4.0"))),),
    notes=("The reversal is decided here.",),
)


def test_the_page_begins_with_the_central_claim_and_counts_come_after(
    toy: ReproductionInput, page: Page
) -> None:
    text = Page(reproduction_page(replace(toy, central=("C26 is open here.", CENTRAL)))).text
    counts = text.index("Of the paper’s 4 claims")
    for said in ("C26", "reverses the ranking", "C26 is open here.", "+5.0", "is decided here"):
        assert 0 <= text.index(said) < counts
    assert "reverses the ranking" not in page.text


def test_a_quick_run_decides_nothing_and_says_where_verdicts_stand(
    toy: ReproductionInput,
) -> None:
    quick = toy.reproduction.model_copy(update={"profile": "quick"})
    console = Console(width=200)
    with console.capture() as captured:
        console.print(ledger_view(ledger(), "quick"))
    page = Page(reproduction_page(replace(toy, reproduction=quick))).text
    for said in (captured.get(), ledger_markdown(ledger(), "quick"), page):
        assert "tests the pipeline" in said
        assert not re.search(r"confirm \d|refute \d|\d confirmed, ✕", said)
    for said in (captured.get(), page):
        assert "docs/reproduction.md" in said


def test_what_another_platform_answered_is_counted_over_the_same_claims() -> None:
    other = ledger().model_copy(update={"platform": "second"})
    few = ledger().model_copy(update={"claims": ledger().claims[:1]})
    said = words.beside(few, other)
    assert "1 confirmed, 0 refuted, 0 undecided" in said
    assert "1 of 1 claims" in said
