"""Why errors add up or cancel: two errors and their sum in one scene, from recorded signals."""

import re
from dataclasses import replace

import numpy as np
import pytest
from page_reader import with_record
from playwright.sync_api import Browser, expect

from faultpath.analyses.pairs import choose, read_pairs
from faultpath.report.adding import adding, adding_panels
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.svg import text_width
from faultpath.run.check.recording import added
from faultpath.run.store.tables import TrialAddress

TOPIC = "error of the predicted acceleration"
SIZES = {"predictor": (2.0, 0.0), "reconstruction": (0.0, -2.0), "shared": (2.0, -1.75)}
STEPS = 40


def errors(one: float, other: float):
    ones = np.ones(STEPS)
    ones[-1] = np.nan
    return added(TOPIC, "m/s^2", {"predictor: thrust": one * ones, "wind: speed": other * ones})


@pytest.fixture
def heard(one_seed: ReportInput) -> ReportInput:
    scene, seed = choose(one_seed.record, pairs_of(one_seed))[0]
    asked = one_seed.record.question
    signals = {
        TrialAddress(variant, condition, seed, scene): errors(*sizes)
        for condition, sizes in SIZES.items()
        for variant in (asked.baseline, asked.repair)
    }
    return replace(one_seed, signals=signals)


def pairs_of(source: ReportInput):
    return read_pairs(source.trials, source.record)


def test_the_first_scene_shows_both_errors_and_their_sum_on_every_condition(heard) -> None:
    shown = adding(heard, pairs_of(heard))
    assert shown is not None
    assert len(shown.conditions) == len(SIZES)
    for (one, other), (_, variants) in zip(SIZES.values(), shown.conditions, strict=True):
        for variant in variants:
            assert variant.sizes == pytest.approx((abs(one), abs(other), abs(one + other)))
    assert "under the shared fault" in shown.caption
    assert shown.caption.count("2.0 and 1.8 m/s²") == 2
    page = report_page(heard)
    first = page[: page.index('<section aria-labelledby="pairs"')]
    assert first.count('class="term both') == 6
    assert f"{TOPIC.capitalize()}, believed minus true" in first
    quiet = tuple(e.model_copy(update={"sign": 0}) for e in heard.record.effects)
    assert 'id="why"' in page
    assert 'id="why"' not in report_page(with_record(heard, effects=quiet)), "nothing to explain"


@pytest.mark.browser
def test_the_lines_are_drawn_anew_in_the_time_that_they_took(
    heard, browser: Browser, tmp_path
) -> None:
    (tmp_path / "why.html").write_text(report_page(heard))
    with browser.new_context(offline=True) as context:
        page = context.new_page()
        page.goto((tmp_path / "why.html").as_uri())
        strip, play = page.locator(".adding .until").first, page.locator("#why-play")
        whole = float(strip.get_attribute("width") or 0)
        assert float(play.get_attribute("data-seconds") or 0) > 0
        play.click()
        page.wait_for_function(
            "(whole) => document.querySelector('.adding .until').getAttribute('width') < whole",
            arg=whole,
        )
        play.click()
        assert float(strip.get_attribute("width") or 0) == whole
        expect(play).to_have_text("Play")


def test_a_few_large_values_do_not_squeeze_the_others_and_are_cut_at_the_axes(heard) -> None:
    """A line along the edge would read as values that lie at it."""
    jump = {
        at: tuple(replace(signal, values=_jumped(signal.values)) for signal in named)
        for at, named in heard.signals.items()
    }
    both = (heard, replace(heard, signals=jump))
    calm, jumped = (adding_panels(adding(each, pairs_of(each))) for each in both)
    levels = [re.findall(r'text-anchor="end">(−?[\d.]+)<', each[0]) for each in (calm, jumped)]
    assert levels[0] == levels[1]
    said = "Lines leave the axes where they are larger, up to 100 m/s²."
    assert [said in report_page(each) for each in both] == [False, True]
    for panel in jumped:
        clips = re.findall(r'<clipPath.*?y="([\d.]+)" width="[\d.]+" height="([\d.]+)"', panel)
        groups = panel.split('<g clip-path="url(#')[1:]
        assert len(clips) == len(groups) == 2
        for (top, height), group in zip(clips, groups, strict=True):
            lines = re.findall(r'<polyline class="term[^"]*" points="([^"]*)"', group)
            ys = [float(point.split(",")[1]) for line in lines for point in line.split()]
            inside = [y for y in ys if float(top) < y < float(top) + float(height)]
            assert len(ys) > len(inside) > 0
            assert not {float(top), float(top) + float(height)} & set(ys)


def test_the_name_of_a_version_and_how_its_trial_ended_keep_apart(heard) -> None:
    """A long way to say the end lay on the name."""
    shown = adding(heard, pairs_of(heard))
    long = replace(
        shown,
        conditions=tuple(
            (title, tuple(replace(of, name="n" * 60, ended="e" * 60) for of in variants))
            for title, variants in shown.conditions
        ),
    )
    for panel in adding_panels(long):
        (name, end), *_ = re.findall(r"<text[^>]*>(n+…).*?<text[^>]*>(e+…)", panel)
        assert 54 + text_width(name, 12) < 308 - text_width(end, 11)


def _jumped(values):
    values = values.copy()
    values[0] = 100.0
    return values


@pytest.mark.parametrize("lost", ["all", "repair", "sum", "numbers"])
def test_without_signals_the_picture_is_left_out(heard, lost) -> None:
    asked = heard.record.question
    left = {
        "all": {},
        "repair": {at: s for at, s in heard.signals.items() if at.variant != asked.repair},
        "sum": {at: named[:2] for at, named in heard.signals.items()},
        "numbers": {
            at: tuple(replace(each, values=each.values * np.nan) for each in named)
            for at, named in heard.signals.items()
        },
    }[lost]
    source = replace(heard, signals=left)
    assert adding(source, pairs_of(source)) is None
    assert "Why:" not in report_page(source)
