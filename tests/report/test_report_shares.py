"""The slider over the share of episodes with the fault: what it may say, and that it says so."""

import json
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from faultpath.record.breakeven_words import clause
from faultpath.report.html import report_page, write_report
from faultpath.report.inputs import ReportInput
from faultpath.report.shares import shares
from faultpath.statistics import Region


def changed(source: ReportInput, signs: tuple[int, int], regions: tuple[Region, ...]):
    """Return the record with its shared path decided so, and nothing on any other."""
    record = source.record
    ends = dict(zip(("correct", "shared"), signs, strict=True))
    effects = tuple(
        e.model_copy(update={"sign": ends.get(e.path, 0), "extreme": None}) for e in record.effects
    )
    correct, faulty = effects[0], next(e for e in effects if e.path == "shared")
    words = clause(record.question, regions, correct, faulty)
    paths = tuple(
        b.model_copy(
            update={
                "result": b.result.model_copy(update={"regions": regions}),
                "words": words if b.path == "shared" else "",
            }
        )
        for b in record.break_even
    )
    return record.model_copy(update={"effects": effects, "break_even": paths}), words


LOW, HIGH = Region(low=0.0, high=0.404, sign=-1), Region(low=0.696, high=1.0, sign=1)
WHOLE = Region(low=0.0, high=1.0, sign=-1)


@pytest.mark.parametrize(
    ("signs", "regions", "decided", "said"),
    [
        ((-1, 1), (LOW, HIGH), [[0, 40, -1], [70, 100, 1]], "up to 40 %"),
        ((-1, -1), (WHOLE,), [[0, 100, -1]], "at every frequency"),
        ((0, -1), (WHOLE,), [[100, 100, -1]], "where the fault is frequent"),
        ((-1, 0), (WHOLE,), [[0, 0, -1]], "where the fault is rare"),
        ((0, 1), (LOW, HIGH), [[70, 100, 1]], "from 70 %"),
        ((0, 0), (LOW, HIGH), [], ""),
        ((-1, 1), (), [], ""),
    ],
)
def test_an_arm_is_ahead_where_the_record_says_so_and_nowhere_else(
    one_seed: ReportInput, signs, regions, decided, said
) -> None:
    record, words = changed(one_seed, signs, regions)
    assert said in words
    assert bool(said) == bool(words)
    paths = {path["title"]: path for path in json.loads(shares(record))["paths"]}
    assert paths["Shared fault"]["decided"] == decided
    assert not any(path["decided"] for title, path in paths.items() if title != "Shared fault")


def test_a_record_without_break_even_has_no_slider(one_seed: ReportInput) -> None:
    record = one_seed.record.model_copy(update={"break_even": ()})
    assert shares(record) == ""


def test_without_a_script_the_slider_is_hidden_and_the_figure_stays(one_seed: ReportInput) -> None:
    page = report_page(one_seed)
    form = page[page.index("<form") : page.index("</form>")]
    assert form[: form.index("<label")].rstrip().endswith("hidden>")
    assert "expected success difference against fault frequency" in page


@pytest.fixture
def page(browser: Browser, one_seed: ReportInput, tmp_path) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 390, "height": 900}, offline=True)
    opened, troubles = context.new_page(), list[str]()
    opened.on("console", lambda message: troubles.append(message.text))
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.goto(write_report(one_seed, tmp_path)[0].as_uri())
    yield opened
    context.close()
    assert troubles == []


@pytest.mark.browser
def test_keys_move_the_share_and_what_is_said_of_it(page: Page, one_seed: ReportInput) -> None:
    told = json.loads(shares(one_seed.record))
    slider, said = page.locator(".shares input"), page.locator(".shares .said")
    slider.focus()
    for key, end in (("Home", 0), ("End", 1)):
        page.keyboard.press(key)
        for number, path in enumerate(told["paths"]):
            page.locator(".shares select").select_option(str(number))
            for arm in ("baseline", "repair"):
                shown = page.locator(f".shares .arm.{arm} output").inner_text()
                assert shown == f"{path[arm][end]:.1f} %"
            sign = next((s for lo, hi, s in path["decided"] if lo <= 100 * end <= hi), 0)
            name = {1: told["repair"], -1: told["baseline"]}.get(sign)
            assert said.inner_text() == (
                f"{name} is ahead." if name else "Who is ahead is not decided."
            )
        slider.focus()
    page.keyboard.press("ArrowLeft")
    assert page.locator(".shares .share").inner_text() == "99 %"
    assert "99 %" in (slider.get_attribute("aria-valuetext") or "")
