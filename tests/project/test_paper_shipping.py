"""`tools/documents.py --paper`: a run is shipped under the platform that it was flown on."""

import json
import shutil
import sys
from pathlib import Path

import pytest

from faultpath.studies import shipped

ROOT = Path(__file__).resolve().parents[2]
FIRST = shipped.shipped_run("first")
PAGES = ("reproduction.html", "tables.tex", "tables.md", "ledger.md")


@pytest.fixture
def paper_blocks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """The blocks of a project with two platforms, neither of them flown."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    sys.modules.pop("paper_blocks", None)
    import paper_blocks

    monkeypatch.setattr(shipped, "platforms", lambda: ("first", "second"))
    monkeypatch.setattr(shipped, "RUNS", tmp_path / "runs")
    return paper_blocks


def finished(folder: Path, platform: str, profile: str = "paper") -> Path:
    """Return a run folder like the shipped one, flown on another platform."""
    shutil.copytree(FIRST, folder)
    for page in PAGES:
        (folder / page).write_text(f"the {page} of {platform}")
    conclusions = folder / "reproduction.json"
    found = json.loads(conclusions.read_bytes())
    found["profile"], found["ledger"]["platform"] = profile, platform
    conclusions.write_text(json.dumps(found))
    return folder


def test_a_run_is_filed_under_its_platform(paper_blocks, tmp_path: Path) -> None:
    assert paper_blocks.present() is None
    assert "not been flown" in paper_blocks.KIND["counts"]()
    paper_blocks.take(finished(tmp_path / "run", "second"), tmp_path / "reference")
    assert shipped.shipped() == ("second",)
    assert (shipped.RUNS / "second" / "outcomes.parquet").is_file()
    page = tmp_path / "reference" / "paper" / "second" / "reproduction.html"
    assert page.read_text() == "the reproduction.html of second"
    assert paper_blocks.present() == "second"
    assert "27 are confirmed" in paper_blocks.KIND["counts"]()


def test_documents_show_the_default_platform_and_others_by_name(
    paper_blocks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for platform in ("first", "second"):
        paper_blocks.take(finished(tmp_path / platform, platform), tmp_path / "reference")
    monkeypatch.setattr(shipped, "default_platform", lambda: "second")
    assert "platform second" in paper_blocks.KIND["ledger"]()
    assert "platform first" in paper_blocks.KIND["ledger"]("first")
    assert paper_blocks.KIND["claim"]("C01", "first").startswith("**C01, ")


def test_platforms_stand_side_by_side(paper_blocks, tmp_path: Path) -> None:
    """With one run there is a column of it, with two there are two, of claims and contrasts."""
    sys.modules.pop("beside_blocks", None)
    import beside_blocks

    assert "not been flown" in beside_blocks.KIND["claims"]()
    for n, platform in enumerate(("first", "second"), 1):
        paper_blocks.take(finished(tmp_path / platform, platform), tmp_path / "reference")
        claims, contrasts = (beside_blocks.KIND[kind]() for kind in ("claims", "contrasts"))
        for text in (claims, contrasts):
            rows = [line for line in text.splitlines() if line.startswith("| ")]
            assert f"Platform {platform} |" in rows[0]
            assert {line.count(" | ") for line in rows[2:]} == {n + 1}
    rows = {line.split(" |")[0]: line for line in claims.splitlines()}
    assert "refuted; 2.06× \\[1.79, 2.43\\]; other size, 2 of 5" in rows["| C01 (platform)"]
    assert "confirmed; +68.0 pp" in rows["| C09"]
    assert "not matched to, so that they had to come out by themselves: C02, C03." in claims
    rows = {line.split(" |")[0]: line for line in contrasts.splitlines()}
    reversal = rows["| GRU+DCC minus GRU, shared"].split(" | ")
    assert reversal[1] == "−11.0 pp \\[−17.3, −5.3\\]"
    assert reversal[2] == "−48.0 pp \\[−56.7, −39.2\\] (right sign, other size)"


@pytest.mark.parametrize(
    ("platform", "profile", "says"),
    [
        ("first", "quick", "is a quick run on platform 'first'"),
        ("nowhere", "paper", "on platform 'nowhere': .* of profile paper on first or second"),
    ],
)
def test_what_is_no_run_of_the_paper_on_a_frozen_platform_is_not_shipped(
    paper_blocks, tmp_path: Path, platform: str, profile: str, says: str
) -> None:
    with pytest.raises(paper_blocks.Wrong, match=says):
        paper_blocks.take(finished(tmp_path / "run", platform, profile), tmp_path / "reference")
    assert shipped.shipped() == ()
