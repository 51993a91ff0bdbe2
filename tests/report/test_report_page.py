"""The page: whole, closed to the network, escaped, and with the record's own numbers."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import pytest
from conftest import unpack

from faultpath.decisions import wording
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput, Traces
from faultpath.report.pairing import Kind, read_pairs

MINUS = "−"
FIGURE_NAMESPACE = "http://www.w3.org/2000/svg"


class Page(HTMLParser):
    """Tags with attributes, cells of tables, and the text that a reader sees."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.words: list[str] = []
        self._inside: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag in ("script", "style", "title"):
            self._inside.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self._inside.append("cell")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("script", "style", "title", "td", "th"):
            self._inside.pop()

    def handle_data(self, data: str) -> None:
        if self._inside and self._inside[-1] == "cell":
            self.rows[-1][-1] += data
        if not self._inside or self._inside[-1] == "cell":
            self.words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))


@pytest.fixture(scope="module", params=[(0,), (0, 1, 2)], ids=["one seed", "three seeds"])
def source(request: pytest.FixtureRequest, make: Callable[..., ReportInput]) -> ReportInput:
    return make(seeds=request.param)


@pytest.fixture(scope="module")
def html(source: ReportInput) -> str:
    return report_page(source)


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def signed(value: float, digits: int = 1) -> str:
    return f"{value:+.{digits}f}".replace("-", MINUS)


def plain(value: float, digits: int = 1) -> str:
    return f"{value:.{digits}f}".replace("-", MINUS)


def test_page_loads_nothing(html: str, page: Page) -> None:
    for _, attributes in page.tags:
        assert attributes.get("src") is None
        target = attributes.get("href") or "#"
        assert target.startswith(("#", "data:,"))
    assert set(re.findall(r"https?://[^\s\"'<>)]+", html)) <= {FIGURE_NAMESPACE}
    assert "@import" not in html
    assert set(re.findall(r"url\(([^)]*)\)", html)) <= set(re.findall(r"url\((#fig-[^)]*)\)", html))


def test_page_is_the_same_every_time(source: ReportInput, html: str) -> None:
    assert report_page(source) == html


def test_names_of_users_are_escaped(html: str, page: Page) -> None:
    assert "<script>alert" not in html
    assert "&lt;script&gt;alert" in html
    assert "<b>no</b>" not in html
    assert [tag for tag, _ in page.tags].count("script") == 2


def test_verdict_comes_first_and_headings_do_not_skip(source: ReportInput, page: Page) -> None:
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))
    assert source.record.verdict.headline in page.text
    assert page.text.index(source.record.verdict.headline) < page.text.index(
        "What the repair changes"
    )


def test_ids_are_unique_and_links_lead_somewhere(page: Page, source: ReportInput) -> None:
    ids = [a["id"] for _, a in page.tags if a.get("id")]
    assert len(ids) == len(set(ids))
    links = [a["href"] for tag, a in page.tags if tag == "a" and a.get("href")]
    trials = {link for link in links if link.startswith("#scene=")}
    assert {link.removeprefix("#") for link in links if link not in trials} <= set(ids)
    cells = [a for tag, a in page.tags if tag == "a" and a.get("class") == "pair"]
    assert len(cells) == len(trials) == len(source.outcomes.rows) / 2


def test_every_figure_is_named(page: Page) -> None:
    figures = [a for tag, a in page.tags if tag == "svg"]
    assert len(figures) > 15
    ids = {a.get("id") for _, a in page.tags}
    for attributes in figures:
        assert set((attributes["aria-labelledby"] or "").split()) <= ids


def test_table_has_the_numbers_of_the_record(source: ReportInput, page: Page) -> None:
    record = source.record
    titles = {path.title: path.name for path in record.paths}
    named = [(row[0].partition(" (primary)")[0], row) for row in page.rows if row]
    rows = {titles[title]: row for title, row in named if title in titles and len(row) == 11}
    breaks = {b.path: b.result for b in record.break_even}
    for effect in record.effects:
        row = rows[effect.path]
        assert row[1:3] == [plain(effect.baseline_percent), plain(effect.repair_percent)]
        assert row[3].startswith(signed(effect.success.value).replace("+0.0", "0.0"))
        adjusted = effect.adjusted_p_value or 0.0
        assert row[6] == ("< 0.001" if adjusted < 0.001 else f"{adjusted:.3f}")
        assert row[7] == plain(effect.minimum_detectable_pp or 0.0)
        assert row[8:10] == [str(effect.scenes), str(effect.void_pairs)]
        result = breaks.get(effect.path)
        assert row[10] == ("–" if result is None else wording.break_even(result))


def test_pairs_of_the_grid_are_those_of_the_record(source: ReportInput) -> None:
    pairs = read_pairs(source.outcomes, source.record)
    for effect in source.record.effects:
        for seed, won, lost in zip(
            source.record.question.seeds, effect.wins, effect.losses, strict=True
        ):
            kinds = [p.kind for p in pairs if (p.path, p.seed) == (effect.path, seed)]
            assert kinds.count(Kind.REPAIR_ONLY) == won
            assert kinds.count(Kind.BASELINE_ONLY) == lost
        kinds = [p.kind for p in pairs if p.path == effect.path]
        assert kinds.count(Kind.VOID) == effect.void_pairs
        assert len(kinds) - kinds.count(Kind.VOID) - kinds.count(Kind.LEFT_OUT) == (
            effect.scenes * len(source.record.question.seeds)
        )


def test_a_path_of_which_every_trial_failed_costs_the_others_nothing(
    make: Callable[..., ReportInput],
) -> None:
    lost = "shared"
    source = make(void=False, n_scenes=40, lost=lost)
    page = Page(report_page(source))
    assert f"40 of {40 * len(source.record.paths)} pairs are void." in page.text
    assert "other pair" not in page.text
    assert page.text.count("no pair of trials is left to compare") == 2  # headline and finding
    assert {
        p.kind for p in read_pairs(source.outcomes, source.record) if p.path != lost
    }.isdisjoint({Kind.VOID, Kind.LEFT_OUT})


def test_viewer_data_cannot_close_its_element(html: str) -> None:
    found = re.search(r'id="viewer-data">(.*?)</script>', html, re.DOTALL)
    assert found is not None
    assert "<" not in found[1]
    assert len(unpack(json.loads(found[1])["packed"])[0]["scenes"]) > 6


def test_page_without_flights_and_void_pairs(make: Callable[..., ReportInput]) -> None:
    source = make(void=False, n_scenes=60)
    bare = replace(source, traces=Traces({}, dt_s=0.05), plans={})
    page = Page(report_page(bare))
    ids = {attributes.get("id") for _, attributes in page.tags}
    assert ids.isdisjoint({"flights", "viewer", "viewer-data"})
    assert "A void pair" not in page.text
