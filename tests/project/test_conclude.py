"""`tools/documents.py --conclude`: stored results follow from their own trials."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import conclude
import pytest

from faultpath.api.folders import MAP, RECORD, SCAN
from faultpath.api.runs import open_run

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"
KINDS = {RECORD: conclude.audit, MAP: conclude.reversal_map, SCAN: conclude.scan}
RESULTS = sorted(path for kind in KINDS for path in REFERENCE.glob(f"*/{kind}"))


def rounded(value: object) -> object:
    """Leave out the last digits of one processor."""
    if isinstance(value, dict):
        return {key: rounded(part) for key, part in value.items()}
    if isinstance(value, list):
        return [rounded(part) for part in value]
    return round(value, 6) + 0.0 if isinstance(value, float) else value


@pytest.mark.parametrize("stored", RESULTS, ids=lambda path: path.parent.name)
def test_a_stored_result_follows_from_its_trials(
    stored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = Path(shutil.copytree(stored.parent, tmp_path / stored.parent.name))
    monkeypatch.setattr(conclude, "open_run", lambda _: SimpleNamespace(report=lambda: None))
    KINDS[stored.name](folder)
    again = json.loads((folder / stored.name).read_bytes())
    assert rounded(again) == rounded(json.loads(stored.read_bytes()))
    if "deliveries.json" in json.loads((folder / "provenance.json").read_bytes()).get("files", {}):
        open_run(folder)


def test_the_order_in_which_points_of_a_map_ran_is_not_in_its_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = Path(shutil.copytree(REFERENCE / "map-toy", tmp_path / "map-toy"))
    run = conclude.load("map-toy")
    turned = run.record.model_copy(update={"points": run.record.points[::-1]})
    again = conclude.reversal_map(folder)
    monkeypatch.setattr(conclude, "load", lambda _: replace(run, record=turned))
    monkeypatch.setattr(conclude.load, "cache_clear", lambda: None, raising=False)
    assert conclude.reversal_map(folder) == again


def test_a_run_decided_anew_is_still_enough_for_report(tmp_path: Path) -> None:
    toy = Path(shutil.copytree(REFERENCE / "toy", tmp_path / "toy"))
    traces = (toy / "traces.parquet").read_bytes()
    record = json.loads((toy / RECORD).read_bytes())
    record["effects"][0]["value"] = 12.345
    (toy / RECORD).write_text(json.dumps(record))
    assert conclude.audit(toy).effects[0].value != 12.345
    before = {path.name: path.read_bytes() for path in toy.iterdir()}
    open_run(toy).report()
    assert {path.name: path.read_bytes() for path in toy.iterdir()} == before
    assert b"12.345" not in b"".join(before.values())
    assert before["traces.parquet"] == traces
