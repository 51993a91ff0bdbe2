"""Pictures in a real browser: nothing lies outside its picture, and no two marks of a key touch."""

import itertools
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from faultpath.analyses.map.record import MapRecord
from faultpath.analyses.pairs import Pair
from faultpath.analyses.scan.record import ScanRecord
from faultpath.api.folders import read_run
from faultpath.report.frame import STYLES
from faultpath.report.html import report_page
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.report.pair_grid import pair_grid
from faultpath.report.scan_pictures import strip, triangle
from faultpath.report.svg import template
from faultpath.system import Outcome, Status

pytestmark = pytest.mark.browser
REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"

OUTSIDE = """() => [...document.querySelectorAll("svg.fig")].flatMap((svg) => {
  const frame = svg.getBoundingClientRect();
  return [...svg.querySelectorAll("rect, circle, path, polygon, polyline, line, text")]
    .filter((part) => !part.closest("defs, clipPath, [clip-path]"))
    .map((part) => [part, part.getBoundingClientRect()])
    .filter(([, b]) => frame.width && (b.left < frame.left - 1 || b.right > frame.right + 1
      || b.top < frame.top - 1 || b.bottom > frame.bottom + 1))
    .map(([part]) => `${svg.querySelector("title").textContent}: ${part.outerHTML}`);
})"""
"""Parts that lie outside their picture by more than a pixel, of every picture that is shown."""

PLACES = """() => [...document.querySelectorAll(".pair")]
  .map((cell) => cell.getBoundingClientRect())
  .map((box) => [Math.round(box.x), Math.round(box.y)])"""

TOUCHING = """(parts) => [...document.querySelectorAll("svg.fig")].flatMap((svg) => {
  const boxes = [...svg.querySelectorAll(parts)]
    .map((part) => [part, part.getBoundingClientRect()]);
  return boxes.flatMap(([one, a], n) => boxes.slice(n + 1)
    .filter(([, b]) => a.left < b.right && b.left < a.right)
    .filter(([, b]) => a.top < b.bottom - 3 && b.top < a.bottom - 3)
    .map(([two]) => `${one.outerHTML} and ${two.outerHTML}`));
})"""
"""Which of the chosen parts of a picture lie on each other; the boxes of lines of text are high."""

DASHED = """() => [...document.querySelectorAll("svg *")]
  .filter((part) => parseFloat(getComputedStyle(part).strokeDasharray) >= 3)
  .map((part) => part.getAttribute("class"))"""
"""Classes of what is drawn with dashes; what is dotted is not among them."""


def shown(browser: Browser, text: str, width: int = 1280) -> Page:
    page = browser.new_page(viewport={"width": width, "height": 900})
    page.set_content(text)
    return page


def pictures(*svgs: str) -> str:
    figures = "".join(f"<figure>{svg}</figure>" for svg in svgs)
    style = "".join(map(template, STYLES))
    return f'<style>{style}</style><main><div class="panels two">{figures}</div></main>'


@pytest.mark.parametrize("seeds", [1, 3])
@pytest.mark.parametrize("groups", [("",), ("rooms", "intersections with a long name")])
@pytest.mark.parametrize("scenes", [1, 24, 25, 60, 300])
def test_all_cells_of_a_grid_lie_in_its_picture(
    browser: Browser, scenes: int, groups: tuple[str, ...], seeds: int
) -> None:
    trial = Outcome(
        "", Status.SUCCESS, 1.0, initial_hash="", disturbance_hash="", planner_noise_hash=""
    )
    pairs = [
        Pair("shared", seed, f"{group}-{index}", index, group, trial, trial)
        for group, index, seed in itertools.product(groups, range(scenes), range(seeds))
    ]
    page = shown(browser, pictures(pair_grid("Shared fault", pairs, {}, {})))
    cells = page.locator(".pair rect")
    assert cells.count() == len(pairs)
    assert page.evaluate(OUTSIDE) == []
    assert len(set(map(tuple, page.evaluate(PLACES)))) == len(pairs)
    page.close()


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("run", ["toy", "pendulum"])
def test_every_picture_of_a_report_holds_its_parts_and_dashes_the_baseline_alone(
    browser: Browser, run: str, width: int
) -> None:
    page = shown(browser, report_page(read_run(REFERENCE / run)), width)
    page.wait_for_selector("#viewer[data-ready]")
    assert page.locator("svg.fig").count() > 15
    assert page.evaluate(OUTSIDE) == []
    dashed = page.evaluate(DASHED)
    assert len(dashed) > 3
    assert [classes for classes in dashed if "baseline" not in classes] == []
    for table in page.locator("div.scroll:has-text('–')").all():
        note = table.locator("+ p")
        assert note.text_content() == "A dash: there is nothing to compute this from."
    page.close()


@pytest.mark.parametrize("run", ["scan-toy", "scan-wpilib"])
def test_the_marks_and_words_of_a_scan_keep_apart(browser: Browser, run: str) -> None:
    record = ScanRecord.model_validate_json((REFERENCE / run / "scan.json").read_bytes())
    (version,) = record.versions
    strips = [strip(record, version, pair).render() for pair in version.listed]
    page = shown(browser, pictures(triangle(record, version).render(), *strips))
    assert page.evaluate(OUTSIDE) == []
    assert page.evaluate(TOUCHING, "text") == []
    page.close()


@pytest.mark.parametrize("run", ["map-toy", "map-camera", "map-quadrotor"])
def test_the_marks_and_words_of_a_map_keep_apart(browser: Browser, run: str) -> None:
    record = MapRecord.model_validate_json((REFERENCE / run / "map.json").read_bytes())
    drawn = map_picture(record).render(), correlation_picture(record).render()
    page = shown(browser, pictures(*drawn))
    assert page.locator(".legend > *").count() == 8
    assert page.evaluate(OUTSIDE) == []
    assert page.evaluate(TOUCHING, ".legend > *") == []
    assert page.evaluate(TOUCHING, "text") == []
    page.close()
