"""Pictures of the documents: parts of the pages of reference runs, as Chromium draws them."""

import hashlib
import json
import shutil
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Literal

from blocks import IMAGES, REFERENCE, Wrong
from run_blocks import PARTS

if TYPE_CHECKING:
    from playwright.sync_api import Browser

MARGIN = 12.0
SCHEMES: tuple[Literal["light"], Literal["dark"]] = ("light", "dark")
MADE_FROM = IMAGES / "made-from.json"
_SMALL = Path(__file__).with_name("smaller.js").read_text("utf-8")
"""Makes a screenshot a tenth of its size."""
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]


def report(run: str) -> Path:
    """Return the page of a reference run."""
    return REFERENCE / run / "report.html"


def digest(run: str) -> str:
    """Return the hash of the report that a picture is made from."""
    return hashlib.sha256(report(run).read_bytes()).hexdigest()


def made_from() -> dict[str, str]:
    """Return, by picture, the hash of the report that it was made from."""
    return json.loads(MADE_FROM.read_text("utf-8")) if MADE_FROM.is_file() else {}


def name_of(run: str, part: str) -> str:
    """Return the file name of a picture."""
    return f"{run}-{part}.svg"


def make_images(pictures: Sequence[tuple[str, str]]) -> None:
    """Take every picture that documents show of a report: run and part."""
    from playwright.sync_api import sync_playwright

    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        raise Wrong("there is no Chromium to make pictures with; install it")
    IMAGES.mkdir(parents=True, exist_ok=True)
    digests: dict[str, str] = {}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        for run, part in pictures:
            (IMAGES / name_of(run, part)).write_text(picture(browser, run, part), "utf-8")
            digests[name_of(run, part)] = digest(run)
        browser.close()
    MADE_FROM.write_text(json.dumps(digests, indent=2, sort_keys=True) + "\n", "utf-8")


def picture(browser: "Browser", run: str, part: str) -> str:
    """Return a part of a run's page as one SVG that is light or dark as its reader has it."""
    shots: list[str] = []
    size = (0.0, 0.0)
    for scheme in SCHEMES:
        page = browser.new_page(
            viewport={"width": 1080, "height": 900},
            color_scheme=scheme,
            reduced_motion="reduce",
            offline=True,
            device_scale_factor=2,
            bypass_csp=True,  # the page's policy refuses the style that is added below
        )
        page.goto(report(run).as_uri())
        if page.query_selector("#viewer-failed"):  # the viewer unpacks its data first
            page.wait_for_selector("#viewer[data-ready]")
        # What stays at the window's edge would lie across the picture.
        page.add_style_tag(content=".contents { position: static }")
        elements = page.query_selector_all(PARTS[part][1])
        areas = [box for element in elements if (box := element.bounding_box())]
        areas = [box for box in areas if box["height"] > 0]
        if not areas:
            raise Wrong(f"the report of {run} has no {part}")
        clip = _around(areas, MARGIN)
        shot = b64encode(page.screenshot(full_page=True, clip=clip)).decode()
        shots.append(page.evaluate(_SMALL, shot))
        size = clip["width"], clip["height"]
        page.close()
    return twice(size, *shots)


def twice(size: tuple[float, float], light: str, dark: str) -> str:
    """Return two pictures, given as data addresses, of which a reader sees the fitting one."""
    (width, height), place = size, Path(__file__).with_name("light_or_dark.svg")
    fields = {"width": f"{width:g}", "height": f"{height:g}", "light": light, "dark": dark}
    return Template(place.read_text("utf-8")).substitute(fields)


def _around(areas: Sequence[Mapping[str, float]], margin: float) -> dict[str, float]:
    left = max(0.0, min(area["x"] for area in areas) - margin)
    top = max(0.0, min(area["y"] for area in areas) - margin)
    right = max(area["x"] + area["width"] for area in areas) + margin
    bottom = max(area["y"] + area["height"] for area in areas) + margin
    return {"x": left, "y": top, "width": right - left, "height": bottom - top}
