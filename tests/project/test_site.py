"""The site builds without a warning, in which Sphinx checks its links, and fetches nothing."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from faultpath.faults import INTERVENTIONS

ROOT = Path(__file__).resolve().parents[2]
OUTWARD = re.compile(
    r"(?:url\(|@import)\s*['\"]?(?:https?:)?//"
    r"|<(?:img|script|source|iframe|video|audio|embed|object|link)\b[^>]*"
    r"\s(?:href|src|srcset|data)=['\"](?:https?:)?//"
)
"""What a page or a style sheet fetches from elsewhere."""


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
    assert "docs/python.md" in guide
    assert [to for to in guide if not (ROOT / to).is_file()] == []


SHORT = """
import faultpath
def load_system(name, load=faultpath.load_system):
    if name == "quadrotor":
        import faultpath_quadrotor.plant.module as module
        module.CONTROL_STEPS = 8
    return load(name)
faultpath.load_system = load_system
"""
"""Beginning of each notebook here: a flight of a few steps shows as much as a whole one."""


@pytest.mark.slow
def test_the_site_builds_and_is_whole(tmp_path: Path) -> None:
    built = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-d", tmp_path / "trees"]
    site = tmp_path / "site"
    kept = {name: str(tmp_path / "jupyter") for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR")}
    (startup := tmp_path / "jupyter" / "profile_default" / "startup").mkdir(parents=True)
    (startup / "short.py").write_text(SHORT)
    done = subprocess.run(
        [*built, ROOT / "docs", site], capture_output=True, text=True, env={**os.environ, **kept}
    )
    assert done.returncode == 0, done.stdout + done.stderr
    shown = [*site.rglob("*.html"), *site.rglob("*.css")]
    assert [file.name for file in shown if OUTWARD.search(file.read_text("utf-8"))] == []
    start = (site / "index.html").read_text("utf-8")
    assert 10 < start.count("toctree-l1") <= 20
    assert 'href="reference/map-toy/report.html"' in start
    guide = re.findall(r"\]\((.*?)\)", (site / "llms.txt").read_text("utf-8"))
    assert [to for to in guide if not (site / to).is_file()] == []
    assert "_held" not in (site / "api" / "front.html").read_text("utf-8")
    for notebook in (ROOT / "docs" / "notebooks").glob("*.ipynb"):
        shown = (site / "notebooks" / f"{notebook.stem}.html").read_text("utf-8")
        assert 'class="highlight-text' in shown, f"{notebook.name} printed nothing"
