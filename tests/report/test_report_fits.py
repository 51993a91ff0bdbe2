"""Pictures in a real browser: nothing lies outside its picture, and no two marks of a key touch."""

from itertools import product
from pathlib import Path

import pytest
from outcomes import outcome
from playwright.sync_api import Browser, Page

from faultpath import compare, open_run
from faultpath.analyses.map.model import MapResult
from faultpath.analyses.pairs import Pair
from faultpath.analyses.scan.model import ScanResult
from faultpath.report.frame import STYLES
from faultpath.report.map import correlation_picture, map_picture
from faultpath.report.pair_grid import pair_grid
from faultpath.report.scan_pictures import strip, triangle
from faultpath.report.svg import template

pytestmark = pytest.mark.browser
REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"

OUTSIDE = """() => {
  document.querySelectorAll("details").forEach((each) => (each.open = true));
  return [...document.querySelectorAll("svg")].flatMap((svg) => {
    const frame = svg.getBoundingClientRect();
    const drawn = "rect, circle, path, polygon, polyline, line, text";
    const parts = svg.matches(".fig") ? drawn : "text";
    return [...svg.querySelectorAll(parts)]
      .filter((part) => !part.closest("defs, clipPath, [clip-path]"))
      .map((part) => [part, part.getBoundingClientRect()])
      .filter(([, b]) => frame.width && b.width && (b.left < frame.left - 1
        || b.right > frame.right + 1 || b.top < frame.top - 1 || b.bottom > frame.bottom + 1))
      .map(([part]) => `${svg.querySelector("title")?.textContent}: ${part.outerHTML}`);
  });
}"""
"""Labels, and parts of pictures, that lie outside their picture by more than a pixel."""

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


def test_all_cells_of_a_grid_lie_in_its_picture(browser: Browser) -> None:
    trial = outcome("")
    sizes = list(
        product((1, 24, 25, 60, 300), (("",), ("rooms", "a long name of its own")), (1, 3))
    )
    grids = [
        [
            Pair("shared", seed, f"{group}-{index}", index, group, trial, trial)
            for group, index, seed in product(groups, range(scenes), range(seeds))
        ]
        for scenes, groups, seeds in sizes
    ]
    drawn = (pair_grid(f"Grid {at}", pairs, {}, {}) for at, pairs in enumerate(grids))
    page = shown(browser, pictures(*drawn))
    count = sum(map(len, grids))
    assert page.locator(".pair rect").count() == count
    assert page.evaluate(OUTSIDE) == []
    assert len(set(map(tuple, page.evaluate(PLACES)))) == count
    page.close()


def reported(name: str, folder: Path) -> Path:
    """Write the page of a reference run, or of three side by side."""
    if name == "side by side":
        runs = [REFERENCE / run for run in ("toy", "pendulum", "quadrotor-L3")]
        return compare(runs).report(folder / "page.html")
    return open_run(REFERENCE / name).report(folder)[0]


@pytest.mark.parametrize(
    "name", ["toy", "pendulum", "quadrotor-L3", "map-toy", "scan-wpilib", "side by side"]
)
def test_every_picture_of_a_page_holds_its_parts_at_all_widths(
    browser: Browser, name: str, tmp_path: Path
) -> None:
    page = browser.new_page()
    page.goto(reported(name, tmp_path).as_uri())
    if audit := page.query_selector("#viewer"):
        page.wait_for_selector("#viewer[data-ready]")
    assert page.locator("svg text").count() > 30
    for width in (390, 800, 1400):
        page.set_viewport_size({"width": width, "height": 900})
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => done()))")
        assert page.evaluate(OUTSIDE) == [], f"at {width} pixels"
    dashed = page.evaluate(DASHED) if audit else ["baseline"]
    assert dashed
    assert [classes for classes in dashed if "baseline" not in classes] == []
    for table in page.locator("div.scroll:has-text('–')").all() if audit else ():
        assert table.locator("+ p").text_content() == (
            "A dash: there is nothing to compute this from."
        )
    page.close()


@pytest.mark.parametrize("run", ["scan-toy", "scan-wpilib"])
def test_the_marks_and_words_of_a_scan_keep_apart(browser: Browser, run: str) -> None:
    record = ScanResult.model_validate_json((REFERENCE / run / "scan.json").read_bytes())
    (version,) = record.versions
    strips = [strip(record, version, pair).render() for pair in version.listed]
    page = shown(browser, pictures(triangle(record, version).render(), *strips))
    assert page.evaluate(OUTSIDE) == []
    assert page.evaluate(TOUCHING, "text") == []
    page.close()


@pytest.mark.parametrize("run", ["map-toy", "map-camera", "map-quadrotor"])
def test_the_marks_and_words_of_a_map_keep_apart(browser: Browser, run: str) -> None:
    record = MapResult.model_validate_json((REFERENCE / run / "map.json").read_bytes())
    drawn = map_picture(record).render(), correlation_picture(record).render()
    page = shown(browser, pictures(*drawn))
    assert page.locator(".legend > *").count() == 8
    assert page.evaluate(OUTSIDE) == []
    assert page.evaluate(TOUCHING, ".legend > *") == []
    assert page.evaluate(TOUCHING, "text") == []
    page.close()
