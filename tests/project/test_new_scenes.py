"""What the documents say of scenes never flown before is decided, and follows from the trials."""

import json
import sys
from pathlib import Path

import pytest

from faultpath.door.saved import as_text
from faultpath.record import DecisionRecord

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "docs" / "reference" / "new-scenes"


def test_the_prose_holds() -> None:
    """As on the held-out scenes at the main job's error; turned round at twice that."""
    signs = {}
    for folder in STORED.iterdir():
        record = DecisionRecord.model_validate_json((folder / "decided.json").read_bytes())
        asked = record.question
        assert (asked.n_scenes, asked.seeds, asked.options["wind"]) == (300, (0,), "L3")
        assert asked.library_hash
        signs[asked.fault] = {effect.path: effect.sign for effect in record.effects}
    expected = {"correct": 0, "predictor": 0, "reconstruction": 1}
    assert signs["calibration=0.1"] == {**expected, "shared": 0}
    turned = signs["calibration=0.2"]
    assert (turned["correct"], turned["reconstruction"], turned["shared"]) == (0, 1, -1)


@pytest.mark.parametrize("size", ["size-1", "size-2"])
def test_the_record_follows_from_the_trials(size: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    sys.modules.pop("conclude", None)
    import conclude

    stored = (STORED / size / "decided.json").read_bytes()
    _, record, _ = conclude._decided(STORED / size, json.loads(stored))
    assert as_text(record).encode() == stored
