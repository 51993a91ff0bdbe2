"""`tools/documents.py --conclude`: stored runs are decided anew from their own outcomes."""

import json
import shutil
from pathlib import Path

import conclude

from faultpath.api.runs import open_run

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference"


def test_a_run_decided_anew_is_still_enough_for_report(tmp_path: Path) -> None:
    toy = Path(shutil.copytree(REFERENCE / "toy", tmp_path / "toy"))
    traces = (toy / "traces.parquet").read_bytes()
    record = json.loads((toy / "record.json").read_bytes())
    record["effects"][0]["value"] = 12.345
    (toy / "record.json").write_text(json.dumps(record))
    now = conclude.audit(toy)
    assert now.effects[0].value != 12.345
    before = {path.name: path.read_bytes() for path in toy.iterdir()}
    open_run(toy).report()
    assert {path.name: path.read_bytes() for path in toy.iterdir()} == before
    assert b"12.345" not in b"".join(before.values())
    assert before["traces.parquet"] == traces


def test_a_scan_decided_anew_from_its_trials_is_the_stored_one(tmp_path: Path) -> None:
    for place in sorted(REFERENCE.glob("*/scan.json")):
        scan = Path(shutil.copytree(place.parent, tmp_path / place.parent.name))
        before = {path.name: path.read_bytes() for path in scan.iterdir()}
        record = json.loads(before["scan.json"])
        record["versions"][0]["pairs"][0]["both"] = 12.345
        (scan / "scan.json").write_text(json.dumps(record))
        conclude.scan(scan)
        assert {name: (scan / name).read_bytes() for name in before} == before


def test_every_reference_folder_with_receipts_is_enough_for_report(tmp_path: Path) -> None:
    for place in sorted(REFERENCE.glob("*/provenance.json")):
        if "deliveries.json" in json.loads(place.read_bytes()).get("files", {}):
            open_run(Path(shutil.copytree(place.parent, tmp_path / place.parent.name)))
