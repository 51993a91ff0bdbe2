"""The page: whole, closed to the network, escaped, and with the record's own numbers."""

import json
import re
from collections.abc import Callable
from itertools import pairwise

import pytest
from page_reader import Page, unpack, with_record

import faultpath.analyses.pairs as page_pairs
from faultpath.analyses.pairs import PairKind, read_pairs
from faultpath.core.text import capital
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.sentences import phrases, words
from faultpath.report.viewer import captions
from faultpath.stats.estimate import DEGREES, EM, TRAININGS


@pytest.fixture(scope="module", params=["one_seed", "three_seeds"])
def source(request: pytest.FixtureRequest) -> ReportInput:
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module")
def html(source: ReportInput) -> str:
    return report_page(source)


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def test_verdict_comes_first_and_headings_do_not_skip(source: ReportInput, page: Page) -> None:
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))
    assert words(source.record).headline in page.text
    assert page.text.index(words(source.record).headline) < page.text.index("in the same scenes")
    assert [tag for tag, _ in page.tags].count("script") == 2


def test_every_pair_leads_to_its_trials(page: Page, source: ReportInput) -> None:
    cells = [a["href"] for tag, a in page.tags if tag == "a" and a.get("class") == "pair"]
    assert len(cells) == len(source.trials) / 2
    assert all((link or "").startswith("#scene=") for link in cells)


def test_every_figure_is_named(page: Page) -> None:
    figures = [a for tag, a in page.tags if tag == "svg"]
    assert len(figures) > 15
    ids = {a.get("id") for _, a in page.tags}
    for attributes in figures:
        assert set((attributes["aria-labelledby"] or "").split()) <= ids


def test_pairs_of_the_grid_are_those_of_the_record(source: ReportInput) -> None:
    pairs = read_pairs(source.trials, source.record)
    for effect in source.record.effects:
        for seed, (won, lost) in zip(source.record.facts.seeds, effect.won, strict=True):
            kinds = [p.kind for p in pairs if (p.condition, p.seed) == (effect.condition, seed)]
            assert kinds.count(PairKind.REPAIR_ONLY) == won
            assert kinds.count(PairKind.BASELINE_ONLY) == lost
        kinds = [p.kind for p in pairs if p.condition == effect.condition]
        assert kinds.count(PairKind.VOID) == effect.void
        scenes = {
            p.scene
            for p in pairs
            if p.condition == effect.condition and p.kind is not PairKind.VOID
        }
        assert len(scenes) == effect.scenes


def test_viewer_data_cannot_close_its_element(html: str) -> None:
    (data,) = re.findall(r'id="viewer-data">(.*?)</script>', html, re.DOTALL)
    assert "<" not in data
    assert len(unpack(json.loads(data)["packed"])[0]["scenes"]) > 6


def test_page_without_void_pairs(make: Callable[..., ReportInput]) -> None:
    assert "A void pair" not in Page(report_page(make(void=False, n_scenes=20))).text


def test_many_scenes_are_counted_and_some_are_listed(
    source: ReportInput, page: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_pairs, "MOST_SCENES", 10)
    many = Page(report_page(source))
    scenes = len(source.trials.scenes)
    assert f"The list has 10 of the {scenes} scenes, evenly chosen" in many.text
    assert "Every scene" in page.text
    assert "Every scene" not in many.text
    assert not [tag for tag, a in many.tags if tag == "a" and a.get("class") == "pair"]
    seeds = len(source.record.facts.seeds)
    kinds = ("both", "repair only", "baseline only", "neither")
    counts = re.findall(", ".join(rf"{kind} (\d+)" for kind in kinds), many.text)
    assert len(counts) == len(source.record.effects)
    for of, effect in zip(counts, source.record.effects, strict=True):
        assert sum(map(int, of)) == scenes * seeds - effect.void
    shown = captions(read_pairs(source.trials, source.record), sampled=True)
    assert all("sampled scenes" in caption for caption in shown.values())


@pytest.mark.parametrize(("void", "scenes"), [(False, True), (True, False)])
def test_what_is_the_same_under_every_condition_is_no_column(
    make: Callable[..., ReportInput], void: bool, scenes: bool
) -> None:
    page = Page(report_page(make(void=void, n_scenes=80)))
    heads = next(row for row in page.rows if "95 % interval" in row)
    assert ("Scenes" in heads, "Void pairs" in heads) == (not scenes, not scenes)
    said = "Scenes, under every condition: 80 (those in which both versions have a trial)."
    assert (said in page.text) == scenes


def test_the_tests_stand_with_the_numbers_and_say_what_they_compute(page: Page, html: str) -> None:
    fold = html[html.index('<details class="more">') :]
    fold = fold[: fold.index("</details>")]
    assert "p, before correction: Correct inputs " in fold
    assert "Holm’s procedure over " in fold
    assert page.text.count("p, before correction: ") == page.text.count("Holm’s procedure") == 1


def test_every_test_has_a_sentence(source: ReportInput) -> None:
    names = [
        *(EM, DEGREES, "exact McNemar", "sign test on scene means", "bets on the mean"),
        *(f"{EM}, normal E", "sign test on scene differences", TRAININGS),
        "t test of the seeds' effects",
    ]
    effect = source.record.effects[0]
    for name in names:
        tested = with_record(source, effects=(effect.model_copy(update={"test": name}),))
        assert f"{capital(name)}: " in phrases.tests(tested.record)
