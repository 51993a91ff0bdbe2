"""The site builds without a warning, leads nowhere that is not there, and fetches nothing."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from faultpath.faults import INTERVENTIONS

ROOT = Path(__file__).resolve().parents[2]
FETCHED = {"img", "script", "source", "iframe", "video", "audio", "embed", "object", "link"}
OUTWARD = re.compile(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//")


class Links(HTMLParser):
    """Collects what a page loads and where it leads, tag by tag."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        places = (value for name, value in attrs if name in ("href", "src", "srcset", "data"))
        self.found += [(tag, place) for place in places if place]


def links(page: Path) -> list[tuple[str, str]]:
    parser = Links()
    parser.feed(page.read_text("utf-8"))
    return parser.found


def fetched(site: Path) -> Iterator[tuple[str, str]]:
    for page in site.rglob("*.html"):
        yield from ((page.name, to) for tag, to in links(page) if tag in FETCHED and "//" in to)
    for sheet in site.rglob("*.css"):
        yield from ((sheet.name, match) for match in OUTWARD.findall(sheet.read_text("utf-8")))


def broken(site: Path) -> Iterator[tuple[str, str]]:
    for page in site.rglob("*.html"):
        for _, to in links(page):
            parts = urlsplit(to)
            inside = parts.path and not parts.scheme and not parts.netloc
            if inside and not (page.parent / unquote(parts.path)).exists():
                yield page.relative_to(site).as_posix(), to


IMPORT = re.compile(r"^from (faultpath[\w.]*) import (?:\(([^)]*)\)|(.*))$", re.M)


def imported(source: str) -> set[tuple[str, str]]:
    """Return what a program imports from faultpath, as module and name."""
    return {
        (module, name)
        for module, *names in IMPORT.findall(source)
        for name in re.findall(r"\w+", "".join(names))
    }


def test_the_api_lists_what_the_guides_import() -> None:
    pages = "".join(page.read_text("utf-8") for page in (ROOT / "docs" / "api").glob("*.md"))
    listed = {
        (module, name)
        for module, names in re.findall(r"automodule:: (\S+)\n   :members: (.+)", pages)
        for name in names.split(", ")
    }
    examples = set((ROOT / "examples").glob("*.py")) - {ROOT / "examples" / "mujoco_plant.py"}
    written = [*(ROOT / "docs").glob("*.md"), *examples]
    wanted = set[tuple[str, str]]().union(*(imported(page.read_text("utf-8")) for page in written))
    assert len(wanted) > 40
    assert wanted - listed - {("faultpath.core.errors", "UserError")} == set()


def test_notebooks_are_stored_without_outputs() -> None:
    for place in (ROOT / "docs" / "notebooks").glob("*.ipynb"):
        cells = json.loads(place.read_text("utf-8"))["cells"]
        assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells), place


def test_every_kind_of_fault_has_its_picture_or_line() -> None:
    page = (ROOT / "docs" / "faults.md").read_text("utf-8")
    assert set(re.findall(r"(?m)^\| (?:!\[|`)(\w+)[\]`]", page)) == set(INTERVENTIONS)


def test_the_start_names_every_page_and_the_guide_for_assistants_leads_to_pages() -> None:
    start = (ROOT / "docs" / "index.md").read_text("utf-8")
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"index.md"}
    assert pages - set(re.findall(r"\]\(([\w-]+\.md)\)", start)) == set()
    guide = re.findall(r"\]\((.*?)\)", (ROOT / "llms.txt").read_text("utf-8"))
    assert "docs/for-assistants.md" in guide
    assert [to for to in guide if not (ROOT / to).is_file()] == []


@pytest.mark.slow
def test_the_site_builds_and_is_whole(tmp_path: Path) -> None:
    built = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-d", tmp_path / "trees"]
    site = tmp_path / "site"
    kept = {name: str(tmp_path / "jupyter") for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR")}
    done = subprocess.run(
        [*built, ROOT / "docs", site], capture_output=True, text=True, env={**os.environ, **kept}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert list(fetched(site)) == []
    assert list(broken(site)) == []
    side_bar = re.findall("toctree-l1", (site / "index.html").read_text("utf-8"))
    assert 10 < len(side_bar) <= 20
    guide = re.findall(r"\]\((.*?)\)", (site / "llms.txt").read_text("utf-8"))
    assert [to for to in guide if not (site / to).is_file()] == []
    assert 'href="reference/map-toy/report.html"' in (site / "index.html").read_text("utf-8")
    assert "_held" not in (site / "api" / "front.html").read_text("utf-8")
    for notebook in (ROOT / "docs" / "notebooks").glob("*.ipynb"):
        shown = (site / "notebooks" / f"{notebook.stem}.html").read_text("utf-8")
        assert 'class="highlight-text' in shown, f"{notebook.name} printed nothing"
