"""What a run computes, whoever computes it and in whatever order."""

from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest
from toy_study import FAULT, SCENES, UNITS, rows, study

from faultpath.core.errors import UserError
from faultpath.loop import NotDelivered, UndeclaredReader
from faultpath.trials.arm import Arm, Row, Study
from faultpath.trials.execution.runner import RunResult, run_study
from faultpath.trials.store.folder import read_outcomes
from faultpath.trials.store.tables import decode_traces
from faultpath.trials.table import TrialRow
from faultpath.trials.work.executor import Progress


@pytest.fixture(scope="session")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    folder = tmp_path_factory.mktemp("whole") / "run"
    return run_study(study(), folder, workers=0), folder


def _comparable(rows: tuple[TrialRow, ...]) -> list[tuple[object, ...]]:
    return [
        (r.variant, r.path, r.seed, r.scene_index, r.topology, *astuple(r.outcome)[:-1])
        for r in rows
    ]


def test_rows_are_in_the_order_of_the_study_then_of_the_library(whole):
    result, _ = whole
    addresses = [(r.variant, r.path, r.seed, r.outcome.scene) for r in result.outcomes.rows]
    assert addresses == [(r.variant, r.path, r.seed, s) for r in rows() for s in SCENES]
    assert result.blocks_computed == UNITS
    assert not result.failures


def test_the_fault_changes_what_it_should(whole):
    result, _ = whole
    table = result.outcomes

    def distances(variant: str, path: str) -> list[float | None]:
        return [r.outcome.metrics["distance"] for r in table.arm(variant, path, 0)]

    assert distances("plain", "shared") == distances("plain", "planner")
    assert distances("plain", "shared") != distances("plain", "correct")
    assert distances("observed", "shared") != distances("observed", "planner")
    faulted = {r.outcome.faulted_steps for r in table.arm("observed", "shared", 0)}
    assert faulted == {9}  # 12 steps, from step 3 on
    assert {r.outcome.altered_steps for r in table.arm("observed", "correct", 0)} == {0}


def test_worker_processes_give_the_same_bytes(whole, tmp_path):
    result, folder = whole
    for workers in (1, 2):
        other = run_study(study(), tmp_path / str(workers), workers=workers)
        assert other.outcomes_sha256 == result.outcomes_sha256
        for name in ("outcomes.parquet", "traces.parquet"):
            assert (tmp_path / str(workers) / name).read_bytes() == (folder / name).read_bytes()


def test_the_tables_read_back(whole):
    result, folder = whole
    table = read_outcomes(folder / "outcomes.parquet")
    assert _comparable(table.rows) == _comparable(result.outcomes.rows)
    traces = decode_traces((folder / "traces.parquet").read_bytes())
    assert traces.keys() == result.traces.keys()
    assert len(traces) == len(table.rows)
    for address, trace in traces.items():
        assert trace.dtype == np.float32
        np.testing.assert_array_equal(trace, result.traces[address])


@pytest.mark.parametrize("scenes", [("s03",), ("s01", "s02", "s05"), SCENES[:4], SCENES[2:9]])
def test_a_selection_gives_the_rows_of_the_whole(whole, tmp_path, scenes):
    result, _ = whole
    part = run_study(study(scenes), tmp_path, workers=0)
    expected = tuple(r for r in result.outcomes.rows if r.outcome.scene in scenes)
    assert _comparable(part.outcomes.rows) == _comparable(expected)


def test_the_order_of_selection_does_not_matter(whole, tmp_path):
    result, _ = whole
    backwards = run_study(study(SCENES[::-1]), tmp_path, workers=0)
    assert backwards.outcomes_sha256 == result.outcomes_sha256


def test_a_quick_look_grows_into_the_whole_and_shares_its_blocks(whole, tmp_path):
    result, _ = whole
    look = run_study(study(SCENES[:4]), tmp_path, workers=0)
    grown = run_study(study(), tmp_path, workers=0)
    assert grown.blocks_kept == look.blocks_computed
    assert grown.blocks_computed == UNITS - look.blocks_computed
    assert grown.outcomes_sha256 == result.outcomes_sha256


def test_running_again_computes_nothing(whole, tmp_path):
    log = tmp_path / "log"
    run_study(study(log=str(log)), tmp_path / "run", workers=0)
    before = log.read_text()
    again = run_study(study(log=str(log)), tmp_path / "run", workers=2)
    assert log.read_text() == before
    assert (again.blocks_computed, again.blocks_kept) == (0, UNITS)
    assert again.outcomes_sha256 == whole[0].outcomes_sha256


def test_an_arm_that_two_rows_share_runs_once(tmp_path):
    log = tmp_path / "log"
    run_study(study(log=str(log)), tmp_path / "run", workers=0, recheck=False)
    assert len(log.read_text().splitlines()) == UNITS


def test_progress_reaches_the_end_and_never_goes_back(tmp_path):
    seen: list[Progress] = []
    run_study(study(), tmp_path, workers=2, progress=seen.append)
    rows = [int(progress.count.split()[0]) for progress in seen]
    assert rows == sorted(rows)
    assert (rows[0], rows[-1], seen[-1].count) == (0, 120, "120 of 120 trials")
    assert seen[-1].done == seen[-1].total == 10 * len(study().arms())
    assert all(0 <= progress.done <= progress.total for progress in seen)


def _study_of(*rows: Row, scenes: tuple[str, ...] = SCENES) -> Study:
    return study().model_copy(update={"rows": rows, "scenes": scenes})


@pytest.mark.parametrize("workers", [0, 1])
@pytest.mark.parametrize(
    ("variant", "consumer", "error"),
    [
        ("deaf", "observer.balance", NotDelivered),
        ("nosy", "planner.thrust", UndeclaredReader),
        ("plain", "observer.balance", UserError),
    ],
)
def test_an_audit_that_is_wrong_stops(tmp_path, variant, consumer, error, workers):
    fault = FAULT.aimed_at(consumer)
    row = Row(variant=variant, path="p", seed=0, arm=Arm(variant=variant, faults=(fault,)))
    with pytest.raises(error, match=r"observer\.balance"):
        run_study(_study_of(row), tmp_path, workers=workers)


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (study(("s00", "nowhere")), "has no scene 'nowhere'"),
        (study(("s00", "s01", "s00")), "selects scene 's00' twice"),
        (study(()), "selects no scene"),
        (_study_of(rows()[0], rows()[0]), "two rows"),
        (
            _study_of(Row(variant="x", path="p", seed=0, arm=Arm(variant="absent"))),
            "has no variant 'absent'",
        ),
    ],
)
def test_a_study_that_cannot_be_run_is_refused(tmp_path, wrong, sentence):
    with pytest.raises(UserError, match=sentence):
        run_study(wrong, tmp_path, workers=0)
