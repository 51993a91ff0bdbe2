"""`tools/documents.py --conclude`: stored runs are decided anew from their own outcomes."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from faultpath.door.run import open_run
from faultpath.record import DecisionRecord

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def conclude(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    sys.modules.pop("conclude", None)
    import conclude

    monkeypatch.setattr(conclude, "REFERENCE", tmp_path)
    monkeypatch.setattr(conclude.shipped, "RUNS", tmp_path / "nothing")
    return conclude


def test_a_stored_run_is_decided_and_shown_anew(conclude, tmp_path: Path) -> None:
    toy = Path(shutil.copytree(ROOT / "docs" / "reference" / "toy", tmp_path / "toy"))
    record = json.loads((toy / "record.json").read_bytes())
    record["verdict"]["headline"] = "Something of before."
    record["effects"] = []
    (toy / "record.json").write_text(json.dumps(record))
    said: list[str] = []
    conclude.conclude_all(said.append)
    now = DecisionRecord.model_validate_json((toy / "record.json").read_bytes())
    assert "Something of before." in said[0]
    assert now.verdict.headline in said[0]
    assert [effect.sign for effect in now.effects] == [-1, 0, 1, -1]
    assert now.question.ends == {"timeout": "missed"}
    page = (toy / "report.html").read_text("utf-8")
    assert now.verdict.headline in page
    assert "calibrated" in (toy / "table.md").read_text("utf-8")
    kept = conclude._tracks(ROOT / "docs" / "reference" / "toy" / "report.html")
    again = conclude._tracks(toy / "report.html")
    assert kept
    assert set(kept) <= set(again)
    assert all((again[key] == kept[key]).all() for key in kept)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of the toy, as whoever makes a reference run has one."""
    folder = tmp_path_factory.mktemp("toy") / "run"
    line = "--baseline calibrated --repair blind --fault gain:scale=0.6 --library carts --scenes 12"
    toy = str(Path("examples") / "toy.py") + ":create"
    code = "from faultpath.cli.main import main; main()"
    command = [sys.executable, "-c", code, "audit", toy, *line.split(), "--workers", "0"]
    subprocess.run([*command, "--out", str(folder)], check=True, cwd=ROOT, capture_output=True)
    return folder


@pytest.fixture
def taken(conclude, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The reference folder that `tools/documents.py --take` makes of it."""
    sys.modules.pop("documents", None)
    import documents as readme

    monkeypatch.setattr(readme, "REFERENCE", tmp_path)
    monkeypatch.setattr(readme, "load", lambda _: None)
    readme.take(f"mine={finished}")
    return tmp_path / "mine"


def test_a_reference_folder_is_enough_for_report(taken: Path) -> None:
    before = {path.name: path.read_bytes() for path in taken.iterdir()}
    open_run(taken).report()
    assert {path.name: path.read_bytes() for path in taken.iterdir()} == before


def test_a_run_decided_anew_is_still_enough_for_report(conclude, taken: Path) -> None:
    """Tracks come from the folder, uncut; the digests are those of what was written anew."""
    record = json.loads((taken / "record.json").read_bytes())
    traces = (taken / "traces.parquet").read_bytes()
    record["verdict"]["headline"] = "Something of before."
    (taken / "record.json").write_text(json.dumps(record))
    conclude.conclude_all(lambda _: None)
    before = {path.name: path.read_bytes() for path in taken.iterdir()}
    open_run(taken).report()
    assert {path.name: path.read_bytes() for path in taken.iterdir()} == before
    assert b"Something of before." not in b"".join(before.values())
    assert before["traces.parquet"] == traces


def test_every_reference_folder_with_receipts_is_enough_for_report(tmp_path: Path) -> None:
    for place in sorted((ROOT / "docs" / "reference").glob("*/provenance.json")):
        if "deliveries.json" in json.loads(place.read_bytes()).get("files", {}):
            open_run(Path(shutil.copytree(place.parent, tmp_path / place.parent.name)))
