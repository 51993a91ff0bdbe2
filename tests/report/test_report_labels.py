"""Every label of every picture lies inside its picture, at all widths."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from faultpath_paper.reproduction import ReproductionRun
from page_reader import with_traces
from playwright.sync_api import Browser

from faultpath import compare, open_run
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput
from faultpath.run.store.signals import DRAWN, Signal
from faultpath.run.store.tables import TrialAddress
from faultpath.system import FloorPlan

pytestmark = pytest.mark.browser
REFERENCE = Path(__file__).parents[2] / "docs" / "reference"
STICKING_OUT = """() => {
  document.querySelectorAll("details").forEach((each) => (each.open = true));
  const out = [];
  let seen = 0;
  for (const text of document.querySelectorAll("svg text")) {
    const whole = text.ownerSVGElement.getBoundingClientRect(), box = text.getBoundingClientRect();
    if (!whole.width || !box.width) continue;
    const most = Math.max(whole.left - box.left, box.right - whole.right, whole.top - box.top, box.bottom - whole.bottom);
    const title = text.ownerSVGElement.querySelector("title")?.textContent;
    seen += 1;
    if (most > 0.5) out.push(`${text.firstChild.textContent} of '${title}' by ${most.toFixed(1)}`);
  }
  return [seen, out];
}"""  # noqa: E501 - as it is easiest to read


def _report(name: str) -> Callable[[Path], Path]:
    def made(folder: Path) -> Path:
        run = open_run(REFERENCE / name)
        assert not isinstance(run, ReproductionRun)
        return run.report(folder)[0]

    return made


def _comparison(folder: Path) -> Path:
    runs = [REFERENCE / run for run in ("toy", "pendulum", "quadrotor-L3")]
    return compare(runs).report(folder / "page.html")


def test_a_cart_has_its_goal(
    make: Callable[..., ReportInput], browser: Browser, tmp_path: Path
) -> None:
    source = make(n_scenes=4, void=False)
    line = with_traces(source.trials, lambda track: track * np.float32([1, 0, 0]))
    rail = FloorPlan((0, 0, 0), (9, 0, 0), (), (), (0, 0, 0), (9.2, 0, 0), "")
    plans = dict.fromkeys(source.system.plans, rail)
    flat = replace(source, trials=line, system=source.system.model_copy(update={"plans": plans}))
    opened = browser.new_page()
    folder = tmp_path / "my cart"
    opened.goto(write_report(flat, folder)[0].as_uri())
    opened.wait_for_selector("#viewer[data-ready]")
    assert opened.locator(".v-goal").count() == len(source.record.conditions)
    assert opened.locator("#viewer text", has_text="goal").count() == len(source.record.conditions)
    opened.close()


def test_a_picture_moves_with_the_clock_and_lifts_its_pen(
    make: Callable[..., ReportInput], browser: Browser, tmp_path: Path
) -> None:
    """Without positions: a cart that drives on, and a mark that stays."""
    source = make(n_scenes=4, void=False)
    system = source.system.model_copy(update={"plans": {}, "control_dt_s": 0.5})
    bare = with_traces(source.trials, lambda track: None)
    source = replace(source, trials=bare, system=system)
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


RUNS = ("toy", "quadrotor-L3", "map-toy", "scan-wpilib")
PAGES = {run: _report(run) for run in RUNS} | {"side": _comparison}


@pytest.mark.parametrize("page", PAGES)
def test_labels_lie_inside_their_pictures(page: str, browser: Browser, tmp_path: Path) -> None:
    made = PAGES[page](tmp_path)
    context = browser.new_context(offline=True)
    opened = context.new_page()
    opened.goto(made.as_uri())
    if opened.query_selector("#viewer"):
        opened.wait_for_selector("#viewer[data-ready]")
    for width in (390, 800, 1400):
        opened.set_viewport_size({"width": width, "height": 900})
        opened.evaluate("() => new Promise((done) => requestAnimationFrame(() => done()))")
        seen, out = opened.evaluate(STICKING_OUT)
        assert seen > 30
        assert not out, f"at {width} pixels: {'; '.join(out)}"
    context.close()
