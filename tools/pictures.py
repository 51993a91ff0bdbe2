"""Pictures of the documents: parts of the pages of reference runs, as Chromium draws them."""

import hashlib
import json
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from blocks import PARTS, REFERENCE, ROOT, Wrong
from paper_blocks import present

MARGIN = 12.0
IMAGES = ROOT / "docs" / "images"
MADE_FROM = IMAGES / "made-from.json"
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]


def report(run: str) -> Path:
    """Return the page of a reference run; `paper` is the run of the paper that is shown."""
    if run == "paper":
        return REFERENCE / run / str(present()) / "reproduction.html"
    return REFERENCE / run / "report.html"


def digest(run: str) -> str:
    """Return the hash of the report that a picture is made from."""
    return hashlib.sha256(report(run).read_bytes()).hexdigest()


def made_from() -> dict[str, str]:
    """Return, by picture, the hash of the report that it was made from."""
    return json.loads(MADE_FROM.read_text("utf-8")) if MADE_FROM.is_file() else {}


def make_images(pictures: Sequence[tuple[str, str]]) -> None:
    """Make every picture that documents show, and drop those that they no longer do."""
    from playwright.sync_api import sync_playwright

    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        raise Wrong("there is no Chromium to make pictures with; install it")
    IMAGES.mkdir(parents=True, exist_ok=True)
    made: dict[str, str] = {}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=ARGUMENTS)
        for run, part in pictures:
            context = browser.new_context(
                viewport={"width": 1080, "height": 900},
                color_scheme="light",
                reduced_motion="reduce",
                offline=True,
                device_scale_factor=2,
                bypass_csp=True,  # the page's policy refuses the style that is added below
            )
            page = context.new_page()
            page.goto(report(run).as_uri())
            # What stays at the window's edge would lie across the picture.
            page.add_style_tag(content=".contents { position: static }")
            wanted = PARTS[part][1] if part in PARTS else f"#{part}"
            boxes = [each.bounding_box() for each in page.query_selector_all(wanted)]
            areas = [box for box in boxes if box is not None and box["height"] > 0]
            if not areas:
                raise Wrong(f"the report of {run} has no {part}")
            clip = _around(areas, 0.0 if run == "paper" else MARGIN)
            name = f"{run}-{part}.png"
            page.screenshot(path=IMAGES / name, full_page=True, clip=clip)
            made[name] = digest(run)
            context.close()
        browser.close()
    for old in IMAGES.glob("*.png"):
        if old.name not in made:
            old.unlink()
    MADE_FROM.write_text(json.dumps(made, indent=2, sort_keys=True) + "\n", "utf-8")


def _around(areas: Sequence[Mapping[str, float]], margin: float) -> dict[str, float]:
    """Return the rectangle around all areas, with a margin."""
    left = max(0.0, min(area["x"] for area in areas) - margin)
    top = max(0.0, min(area["y"] for area in areas) - margin)
    right = max(area["x"] + area["width"] for area in areas) + margin
    bottom = max(area["y"] + area["height"] for area in areas) + margin
    return {"x": left, "y": top, "width": right - left, "height": bottom - top}
