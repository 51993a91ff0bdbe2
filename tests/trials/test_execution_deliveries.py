"""What the taps did reaches the run, its folder and every later invocation."""

import pytest
from toy_study import FAULT, SCENES, study
from toy_system import STEPS

from faultpath.core.files import parquet
from faultpath.loop import TapCount
from faultpath.trials import Deliveries
from faultpath.trials.execution.runner import run_study
from faultpath.trials.store import tables

FAULTED = (STEPS - FAULT.onset_step) * len(SCENES)
EACH = STEPS * len(SCENES)


@pytest.mark.parametrize("workers", [0, 2])
def test_every_row_brings_what_its_taps_did(tmp_path, workers):
    result = run_study(study(), tmp_path, workers=workers)
    planner = TapCount("mass", "planner.thrust", EACH, FAULTED, FAULTED)
    whole = TapCount("mass", "observer.balance", EACH, FAULTED, FAULTED)
    clean = TapCount("mass", "observer.balance", EACH, 0, 0)
    by_address = {(r.variant, r.path, r.seed): r.taps for r in result.deliveries.rows}
    assert by_address["observed", "planner", 1] == (planner, clean)
    assert by_address["observed", "shared", 0] == (planner, whole)
    assert by_address["plain", "shared", 0] == (planner,)
    assert by_address["plain", "correct", 0] == (TapCount("mass", "planner.thrust", EACH, 0, 0),)
    both = result.deliveries.at("observed", "shared")
    assert both[0] == TapCount("mass", "planner.thrust", 2 * EACH, 2 * FAULTED, 2 * FAULTED)
    with pytest.raises(KeyError):
        result.deliveries.at("observed", "elsewhere")


def test_kept_blocks_bring_them_too_and_the_folder_holds_them(tmp_path):
    first = run_study(study(SCENES[:4]), tmp_path, workers=0)
    grown = run_study(study(), tmp_path, workers=0)
    again = run_study(study(), tmp_path, workers=0)
    assert (again.blocks_computed, again.deliveries) == (0, grown.deliveries)
    assert first.deliveries != grown.deliveries
    stored = (tmp_path / "deliveries.json").read_bytes()
    assert Deliveries.model_validate_json(stored) == grown.deliveries


def test_a_scene_that_failed_brings_nothing(tmp_path):
    result = run_study(study(raises="s05"), tmp_path, workers=0)
    (planner,) = result.deliveries.at("plain", "correct")
    assert planner.deliveries == 2 * STEPS * (len(SCENES) - 1)


def test_a_shard_of_before_is_named_and_run_again(tmp_path, monkeypatch):
    before = run_study(study(), tmp_path / "new", workers=0)
    with monkeypatch.context() as patch:
        encode = parquet.encode
        patch.setattr(tables, "encode", lambda columns, values, notes=None: encode(columns, values))
        run_study(study(), tmp_path / "old", workers=0)
    notices: list[str] = []
    after = run_study(study(), tmp_path / "old", workers=0, notice=notices.append)
    assert after.blocks_kept == 0
    assert len(notices) == after.blocks_computed
    assert all("kept no receipts" in notice for notice in notices)
    assert after.deliveries == before.deliveries
