"""The page in a real browser, without a network: it draws, answers and stays quiet."""

import re
import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from page_reader import with_system, with_traces
from playwright.sync_api import Browser, Page, expect

from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput
from faultpath.run.store.signals import DRAWN, Signal
from faultpath.run.store.tables import TrialAddress
from faultpath.run.trials import Trials
from faultpath.system import FloorPlan

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def address(make: Callable[..., ReportInput], tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("report")
    return write_report(make(seeds=(0, 1, 2), n_scenes=20), folder)[0].as_uri()


@pytest.fixture(params=[(1280, "light"), (390, "dark")], ids=["desktop", "telephone"])
def page(request: pytest.FixtureRequest, browser: Browser, address: str) -> Iterator[Page]:
    width, scheme = request.param
    context = browser.new_context(
        viewport={"width": width, "height": 900},
        color_scheme=scheme,
        offline=True,
        reduced_motion="reduce",
    )
    opened = context.new_page()
    troubles: list[str] = []
    opened.on("console", lambda message: troubles.append(message.text))
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.on("dialog", lambda dialog: troubles.append(f"dialog: {dialog.message}"))
    opened.on(
        "request", lambda sent: None if sent.url.startswith(address) else troubles.append(sent.url)
    )
    opened.goto(address)
    opened.wait_for_selector("#viewer[data-ready]")
    yield opened
    context.close()
    assert [trouble for trouble in troubles if not trouble.startswith("data:,")] == []


def test_pictures_have_a_size_and_nothing_sticks_out(page: Page) -> None:
    page.evaluate("() => document.querySelectorAll('details').forEach((d) => (d.open = true))")
    sizes = page.evaluate(
        """() => [...document.querySelectorAll("svg.fig, #viewer svg")]
          .filter((e) => !e.closest("[hidden]"))
          .filter((e) => getComputedStyle(e.closest("figure, li") ?? e).display !== "none")
          .map((e) => e.getBoundingClientRect()).map((r) => [r.width, r.height])"""
    )
    assert len(sizes) > 15
    assert all(width > 8 and height > 8 for width, height in sizes)
    sideways = page.evaluate(
        "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    )
    assert sideways <= 0


def test_scene_and_time_move_the_trials(page: Page) -> None:
    columns = page.locator("#viewer-across .column:visible")
    assert columns.count() == page.locator("#viewer-across .plan svg:visible").count() == 4
    before = columns.first.inner_html()
    page.locator("#viewer-scene").select_option(index=1)
    second = columns.first.inner_html()
    assert second != before
    page.locator("#viewer-time").fill("10")
    assert page.locator("#viewer-clock").inner_text() == "0.50 s"
    assert columns.first.inner_html() != second
    assert columns.first.locator(".v-dot").count() == 2
    page.locator("#viewer-time").press("ArrowRight")
    assert page.locator("#viewer-clock").inner_text() == "0.55 s"
    page.locator("#viewer-play").click()
    expect(page.locator("#viewer-clock")).not_to_have_text("0.55 s")
    page.locator("#viewer-play").click()
    stopped = page.locator("#viewer-clock").inner_text().removesuffix(" s")
    assert page.evaluate("location.hash").endswith(f"&t={stopped}")


def test_a_cell_leads_to_its_trial_and_the_address_brings_it_back(page: Page) -> None:
    grid = page.locator("[data-pairs] svg").nth(1)
    cell = grid.locator("a").nth(1).get_attribute("href")
    assert cell.startswith("#scene=")
    assert cell.endswith("&condition=predictor")
    grid.locator("a").nth(1).click()
    if page.viewport_size and page.viewport_size["width"] < 400:  # cells are less than 24 px there
        around = page.locator("#cells a")
        assert 1 < around.count() < 30
        assert all(box and box["height"] >= 24 for box in (a.bounding_box() for a in around.all()))
        page.locator(f'#cells a[href="{cell}"]').click()
    expect(page.locator("#cells")).not_to_be_visible()
    expect(page.locator("#viewer-play")).to_be_focused()
    assert page.evaluate("location.hash") == cell
    scene = page.evaluate("decodeURIComponent(location.hash.slice(7).split('&')[0])")
    assert scene in page.locator("#viewer-scene option:checked").inner_text()
    chosen = page.locator("#viewer-across .chosen")
    assert chosen.get_attribute("data-condition") == "predictor"
    page.goto(page.url.partition("#")[0] + cell.replace("predictor", "shared") + "&t=0.20")
    expect(page.locator("#viewer-clock")).to_have_text("0.20 s")
    assert chosen.get_attribute("data-condition") == "shared"
    page.goto(page.url.partition("#")[0] + "#scene=no&seed=%E0%A4%A")
    assert chosen.get_attribute("data-condition") == "shared"


def test_the_list_of_scenes_is_filtered_by_who_succeeds(page: Page) -> None:
    show, scenes = page.locator("#viewer-show"), page.locator("#viewer-scene")
    whole = scenes.locator("option").count()
    labels = show.locator("option").all_inner_texts()
    assert labels[0].startswith("all trials (")
    chosen = next(n for n, label in enumerate(labels) if "only the repair succeeds" in label)
    show.select_option(index=chosen)
    count = int(labels[chosen].rpartition("(")[2].rstrip(")"))
    assert scenes.locator("option:enabled").count() == min(count, 30) < whole
    title = labels[chosen].partition(":")[0]
    column = page.locator(".column").filter(has=page.get_by_role("heading", name=title))
    assert "repair: ✓" in column.inner_text()
    assert "baseline: ✓" not in column.inner_text()
    page.goto(page.url.partition("#")[0] + "#scene=" + "no")
    page.locator("[data-pairs] svg a").first.dispatch_event("click")
    expect(scenes.locator("option")).to_have_count(whole)


def test_a_trial_that_was_not_recorded_shows_its_end_and_how_to_run_it_again(
    one_seed: ReportInput, browser: Browser, tmp_path: Path
) -> None:
    names = {"rooms-004": "it's <here>"}
    rows = [
        replace(
            row, outcome=replace(row.outcome, scene=names.get(row.outcome.scene, row.outcome.scene))
        )
        for row in with_traces(one_seed.trials, lambda track: None)
    ]
    steps = np.arange(5, dtype=np.float32)[:, None]
    at = TrialAddress("gru", "shared", 0, "clutter-000")
    source = replace(
        with_system(one_seed, plans={}),
        trials=Trials.of(rows),
        signals={at: (Signal("thrust", "thrust", "N", steps),)},
    )
    page = browser.new_page(offline=True)
    page.goto(write_report(source, tmp_path / "a run")[0].as_uri())
    show = page.locator("#viewer-show option").first
    expect(show).to_have_text("1 of 80 scenes recorded", use_inner_text=True)
    page.locator('[data-condition="shared"] [data-scene="it\'s <here>"]').click()
    dialog = page.locator("#cells")
    assert re.search(r"it's <here>, seed 0: baseline \w+, repair \w+", dialog.inner_text())
    faultpath, replay, *rest = shlex.split(dialog.locator("code").inner_text())
    assert (faultpath, replay) == ("faultpath", "replay")
    assert rest == [str(tmp_path / "a run"), "--scene=it's <here>", "--condition=shared"]
    dialog.get_by_role("button", name="Close").click()
    expect(dialog).not_to_be_visible()
    page.close()


def test_a_cart_has_its_goal(
    make: Callable[..., ReportInput], browser: Browser, tmp_path: Path
) -> None:
    source = make(n_scenes=4, void=False)
    line = with_traces(source.trials, lambda track: track * np.float32([1, 0, 0]))
    rail = FloorPlan((0, 0, 0), (9, 0, 0), (), (), (0, 0, 0), (9.2, 0, 0), "")
    plans = dict.fromkeys(source.system.plans, rail)
    flat = replace(with_system(source, plans=plans), trials=line)
    opened = browser.new_page()
    folder = tmp_path / "my cart"
    opened.goto(write_report(flat, folder)[0].as_uri())
    opened.wait_for_selector("#viewer[data-ready]")
    assert opened.locator(".v-goal").count() == len(source.record.conditions)
    assert opened.locator("#viewer text", has_text="goal").count() == len(source.record.conditions)
    opened.close()


def test_signs_at_the_ends_of_positions_without_a_plan_are_whole(
    one_seed: ReportInput, browser: Browser, tmp_path: Path
) -> None:
    opened = browser.new_page(viewport={"width": 1280, "height": 900})
    opened.goto(write_report(with_system(one_seed, plans={}), tmp_path)[0].as_uri())
    opened.wait_for_selector("#viewer[data-ready]")
    room = opened.evaluate(
        """() => [...document.querySelectorAll("#viewer-across .plan .v-end")].flatMap((sign) => {
          const [a, b] = [sign, sign.closest(".plan")].map((e) => e.getBoundingClientRect());
          return [a.left - b.left, b.right - a.right, a.top - b.top, b.bottom - a.bottom];
        })"""
    )
    assert min(room) > 3, "half of the line around a sign"
    opened.close()


def test_a_picture_moves_with_the_clock_and_lifts_its_pen(
    make: Callable[..., ReportInput], browser: Browser, tmp_path: Path
) -> None:
    """Without positions: a cart that drives on, and a mark that stays."""
    source = make(n_scenes=4, void=False)
    bare = with_traces(source.trials, lambda track: None)
    source = replace(with_system(source, plans={}, control_dt_s=0.5), trials=bare)
    steps, lift = np.arange(9.0, dtype=np.float32)[:, None], np.full((9, 2), np.nan, np.float32)
    cart = np.hstack([steps, steps * 0, steps + 2, steps * 0, lift, steps * 0 + 5, steps * 0 + 1])
    named = (
        Signal(DRAWN, DRAWN, "m", np.hstack([cart, steps * 0 + 5, steps * 0 + 2])),
        Signal("body", "body", "m, rad", np.hstack([steps, -steps]), ("place", "angle")),
    )
    heard = {
        TrialAddress(r.variant, r.condition, r.seed, r.outcome.scene): named for r in source.trials
    }
    opened = browser.new_page()
    written = write_report(replace(source, signals=heard), tmp_path / "cart")
    opened.goto(f"{written[0].as_uri()}#scene={source.trials.scenes[0].id}&t=0")
    opened.wait_for_selector("#viewer[data-ready]")
    line = opened.locator("#viewer-across .plan path.v-track").first
    began = line.get_attribute("d") or ""
    assert [began.count(letter) for letter in "ML"] == [2, 2]
    opened.locator("#viewer-time").fill("4")
    moved = line.get_attribute("d") or ""
    assert moved != began
    assert moved.split("M")[2] == began.split("M")[2]
    titles = opened.locator("#viewer-signal option").all_inner_texts()
    assert titles == ["body, place (m)", "body, angle (rad)"]
    opened.close()


def test_the_rest_unfolds_by_key_and_words_find_a_scene_among_many(page: Page) -> None:
    first = page.locator(".verdict details.more p").first
    assert not first.is_visible()
    page.locator(".verdict details.more summary").focus()
    page.keyboard.press("Enter")
    assert first.is_visible()
    find, scenes = page.locator("#viewer-find"), page.locator("#viewer-scene")
    assert "more: type to find one" in scenes.locator("option").last.inner_text()
    assert scenes.locator("option").count() < 45
    find.fill("ROOMS seed 2 00")
    options = scenes.locator("option").all_inner_texts()
    assert options == [f"rooms-{number:03d}, rooms, seed 2" for number in (4, 9)]
    assert page.evaluate("location.hash").startswith("#scene=rooms-004&seed=2&")
    find.fill("nowhere")
    assert scenes.locator("option").last.inner_text() == "no scene has these words"
    assert page.evaluate("location.hash").startswith("#scene=rooms-004&seed=2&")


def test_the_bar_marks_where_two_trials_part_and_leads_there(
    one_seed: ReportInput, browser: Browser, tmp_path: Path
) -> None:
    steps = np.arange(30, dtype=np.float32)[:, None]
    signals = {
        TrialAddress(name, condition, 0, "clutter-000"): (
            Signal("reconstructed_wind", "wind", "m/s", np.where(steps < after, 0, steps)),
        )
        for condition, parted in (("shared", 7), ("predictor", 9))
        for name, after in (("gru", 99), ("gru-dcc", parted))
    }
    page = browser.new_page(offline=True)
    page.goto(write_report(replace(one_seed, signals=signals), tmp_path / "run")[0].as_uri())
    page.goto(page.url + "#scene=clutter-000&seed=0&condition=shared&t=1")
    said, marks = page.locator("#viewer-said"), page.locator("#viewer-marks button")
    expect(said).to_contain_text("Shared fault. At")
    assert page.locator('#viewer-ticks option[value="7"]').count() == 1
    marks.filter(has_text="0.35 s: readings differ").click()
    expect(page.locator("#viewer-clock")).to_have_text("0.35 s")
    page.get_by_role("button", name="Predictor only").click()
    expect(said).to_contain_text("Predictor only. At")
    assert marks.filter(has_text="0.45 s: readings differ").count() == 1
    assert "condition=predictor&t=0.35" in page.evaluate("location.hash")
    page.get_by_role("button", name="Correct inputs").click()
    expect(page.locator("#viewer-parting")).to_be_hidden()
    page.close()
