"""Pictures in a real browser: nothing lies outside its picture, and no two marks of a key touch."""

import itertools

import pytest
from playwright.sync_api import Browser, Page

from faultpath.decisions.pairs import Pair
from faultpath.report.frame import STYLES
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.pair_grid import pair_grid
from faultpath.report.svg import template
from faultpath.trials import Outcome, Status

pytestmark = pytest.mark.browser

OUTSIDE = """() => [...document.querySelectorAll("svg.fig")].flatMap((svg) => {
  const frame = svg.getBoundingClientRect();
  return [...svg.querySelectorAll("rect, circle, path, polygon, polyline, line, text")]
    .filter((part) => !part.closest("defs, clipPath, [clip-path]"))
    .map((part) => [part, part.getBoundingClientRect()])
    .filter(([, b]) => frame.width && (b.left < frame.left - 1 || b.right > frame.right + 1
      || b.top < frame.top - 1 || b.bottom > frame.bottom + 1))
    .map(([part]) => `${svg.querySelector("title").textContent}: ${part.outerHTML}`);
})"""
"""What lies outside its picture by more than a pixel, of every picture that is shown."""

PLACES = """() => [...document.querySelectorAll(".pair")].map((cell) => cell.getBoundingClientRect())
  .map((box) => [Math.round(box.x), Math.round(box.y)])"""


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
    page = shown(browser, pictures(pair_grid("Shared fault", pairs, {})))
    cells = page.locator(".pair rect")
    assert cells.count() == len(pairs)
    assert page.evaluate(OUTSIDE) == []
    assert len(set(map(tuple, page.evaluate(PLACES)))) == len(pairs)
    page.close()


@pytest.mark.parametrize("width", [1280, 390])
def test_every_picture_of_a_report_holds_all_of_its_parts(
    browser: Browser, three_seeds: ReportInput, width: int
) -> None:
    page = shown(browser, report_page(three_seeds), width)
    assert page.locator("svg.fig").count() > 15
    assert page.evaluate(OUTSIDE) == []
    page.close()
