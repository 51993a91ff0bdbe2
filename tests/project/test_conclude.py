"""`tools/readme.py --conclude`: stored runs are decided anew from their own outcomes."""

import json
import shutil
import sys
from pathlib import Path

import pytest

from faultpath.record import DecisionRecord

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def conclude(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    sys.modules.pop("conclude", None)
    import conclude

    monkeypatch.setattr(conclude, "REFERENCE", tmp_path)
    monkeypatch.setattr(conclude, "SHIPPED", tmp_path / "nothing")
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
    assert set(again) <= set(kept)
    assert all((again[key] == kept[key]).all() for key in again)
