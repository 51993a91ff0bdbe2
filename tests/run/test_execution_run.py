"""What a run computes, whoever computes it and in whatever order."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from toy_plan import FAULT, SCENES, UNITS, plan, rows
from weighed import ToySystem

from faultpath.core.errors import UserError
from faultpath.loop import NotDelivered, TapCount, UndeclaredReader
from faultpath.run.execution.runner import RunResult, run_plan
from faultpath.run.plan import Plan, Row, TaskQueue, Treatment, Unit, units_of
from faultpath.run.store.folder import RunFolder, read_outcomes
from faultpath.run.store.tables import decode_traces, traces_of
from faultpath.run.trials import Trial
from faultpath.run.work.executor import Progress
from faultpath.system.declared import Library, SceneRef


@pytest.fixture(scope="session")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    folder = tmp_path_factory.mktemp("whole") / "run"
    return run_plan(plan(), folder, workers=0), folder


def _comparable(rows: tuple[Trial, ...]) -> list[tuple[object, ...]]:
    return [
        (r.variant, r.condition, r.seed, r.scene_index, r.topology, replace(r.outcome, trace=None))
        for r in rows
    ]


def test_rows_are_in_the_order_of_the_plan_then_of_the_library(whole):
    result, _ = whole
    addresses = [(r.variant, r.condition, r.seed, r.outcome.scene) for r in result.trials]
    assert addresses == [(r.variant, r.condition, r.seed, s) for r in rows() for s in SCENES]
    assert result.blocks_computed == UNITS
    assert not result.failures


def test_the_fault_changes_what_it_should(whole):
    result, _ = whole
    table = result.trials

    def distances(variant: str, condition: str) -> list[float | None]:
        return [o.metrics["distance"] for o in table.outcomes(variant, condition, 0)]

    assert distances("plain", "shared") == distances("plain", "planner")
    assert distances("plain", "shared") != distances("plain", "correct")
    assert distances("observed", "shared") != distances("observed", "planner")
    faulted = {o.faulted_steps for o in table.outcomes("observed", "shared", 0)}
    assert faulted == {9}  # 12 steps, from step 3 on
    assert {o.altered_steps for o in table.outcomes("observed", "correct", 0)} == {0}


def test_worker_processes_give_the_same_bytes_and_progress_never_goes_back(whole, tmp_path):
    result, folder = whole
    seen: list[Progress] = []
    other = run_plan(plan(), tmp_path, workers=2, progress=seen.append)
    assert other.outcomes_sha256 == result.outcomes_sha256
    for name in ("outcomes.parquet", "traces.parquet", "deliveries.json"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()
    rows = [int(progress.count.split()[0]) for progress in seen]
    assert rows == sorted(rows)
    assert (rows[0], rows[-1], seen[-1].count) == (0, 120, "120 of 120 trials")
    assert seen[-1].done == seen[-1].total == 10 * len(plan().treatments())
    assert all(0 <= progress.done <= progress.total for progress in seen)


def test_the_tables_read_back(whole):
    result, folder = whole
    table = read_outcomes(folder / "outcomes.parquet")
    assert _comparable(table) == _comparable(result.trials)
    traces = decode_traces((folder / "traces.parquet").read_bytes())
    assert traces.keys() == traces_of(result.trials).keys()
    assert len(traces) == len(table)
    for address, trace in traces.items():
        assert trace.dtype == np.float32
        np.testing.assert_array_equal(trace, traces_of(result.trials)[address])


@pytest.mark.parametrize("scenes", [("s03",), SCENES[2:9], SCENES[::-1]])
def test_a_selection_in_any_order_gives_the_rows_of_the_whole(whole, tmp_path, scenes):
    result, _ = whole
    part = run_plan(plan(scenes), tmp_path, workers=0)
    expected = tuple(r for r in result.trials if r.outcome.scene in scenes)
    assert _comparable(part.trials) == _comparable(expected)


def test_every_row_brings_what_its_taps_did(whole):
    deliveries = whole[0].deliveries
    every = ToySystem.steps * len(SCENES)
    faulted = (ToySystem.steps - FAULT.onset_step) * len(SCENES)
    planner = TapCount("mass", "planner.thrust", every, faulted, faulted)
    struck = TapCount("mass", "observer.balance", every, faulted, faulted)
    spared = TapCount("mass", "observer.balance", every, 0, 0)
    taps = {(row.variant, row.condition, row.seed): row.taps for row in deliveries.rows}
    assert taps["observed", "planner", 1] == (planner, spared)
    assert taps["observed", "shared", 0] == (planner, struck)
    assert taps["plain", "shared", 0] == (planner,)
    assert taps["plain", "correct", 0] == (TapCount("mass", "planner.thrust", every, 0, 0),)
    both = TapCount("mass", "planner.thrust", 2 * every, 2 * faulted, 2 * faulted)
    assert deliveries.at("observed", "shared")[0] == both
    with pytest.raises(KeyError):
        deliveries.at("observed", "elsewhere")


def test_bookkeeping_grows_with_the_rows_and_not_with_rows_times_blocks(tmp_path, monkeypatch):
    calls: list[str] = []
    key, list_shards = Treatment.key, RunFolder.list_shards
    monkeypatch.setattr(Treatment, "key", lambda treatment: calls.append("key") or key(treatment))
    monkeypatch.setattr(
        RunFolder, "list_shards", lambda folder: calls.append("list") or list_shards(folder)
    )
    counts: list[Counter[str]] = []
    for scenes in (SCENES[:2], SCENES):
        calls.clear()
        run_plan(plan(scenes), tmp_path / str(len(scenes)), workers=0)
        counts.append(Counter(calls))
    assert counts[0] == counts[1]


def test_the_work_of_a_block_is_counted_once_and_not_for_each_block_that_is_taken():
    class Scenes(tuple[str, ...]):
        counted = 0

        def __len__(self) -> int:
            Scenes.counted += 1
            return super().__len__()

    sizes = [1, 3, 2, 3, *[1] * 96]
    treatment = Treatment(variant="plain")
    units = [
        Unit(f"{block}", treatment, "t", block, Scenes(f"s{n}" for n in range(size)))
        for block, size in enumerate(sizes)
    ]
    queue = TaskQueue(units, in_order=False)
    taken = [task.unit.block for task in iter(lambda: queue.take(0), None)]
    assert taken == [1, 3, 2, 0, *range(4, 100)]
    assert Scenes.counted == len(sizes)


def test_rows_of_one_condition_may_have_scenes_of_their_own(tmp_path: Path) -> None:
    """As if it were one row with all of them; each has its own deliveries."""
    early, late = Treatment(variant="observed"), Treatment(variant="plain")
    rows = [
        Row(variant="observed", condition="correct", seed=0, treatment=early, scenes=SCENES[:2]),
        Row(variant="observed", condition="correct", seed=0, treatment=early, scenes=SCENES[2:]),
        Row(variant="plain", condition="correct", seed=0, treatment=late, scenes=SCENES[2:]),
    ]
    parts = run_plan(_plan_of(*rows), tmp_path / "parts", workers=0)
    whole = run_plan(
        _plan_of(Row(variant="observed", condition="correct", seed=0, treatment=early)),
        tmp_path / "whole",
        workers=0,
    )
    ends = [run.trials.outcomes("observed", "correct", 0) for run in (parts, whole)]
    assert [o.trajectory_hash for o in ends[0]] == [o.trajectory_hash for o in ends[1]]
    assert [o.scene for o in parts.trials.outcomes("plain", "correct", 0)] == [*SCENES[2:]]
    assert parts.deliveries.at("observed", "correct") == whole.deliveries.at("observed", "correct")


def _plan_of(*rows: Row) -> Plan:
    return plan().model_copy(update={"rows": rows})


@pytest.mark.parametrize(
    ("variant", "reader", "error", "workers"),
    [
        ("deaf", "observer.balance", NotDelivered, 0),
        ("nosy", "planner.thrust", UndeclaredReader, 0),
        ("nosy", "planner.thrust", UndeclaredReader, 1),
        ("plain", "observer.balance", UserError, 0),
    ],
)
def test_an_audit_that_is_wrong_stops(tmp_path, variant, reader, error, workers):
    fault = FAULT.aimed_at(reader)
    row = Row(
        variant=variant,
        condition="p",
        seed=0,
        treatment=Treatment(variant=variant, faults=(fault,)),
    )
    with pytest.raises(error, match=r"observer\.balance"):
        run_plan(_plan_of(row), tmp_path, workers=workers)


def test_a_key_names_everything_that_decides_a_result():
    first = Treatment(variant="v")
    row = Row(variant="v", condition="correct", seed=0, treatment=first)
    other_row = row.model_copy(update={"treatment": Treatment(variant="v", seed=1)})
    one, other_treatment, other_scene = (
        plan((scene,)).model_copy(update={"rows": (of,)})
        for scene, of in (("s0", row), ("s0", other_row), ("s1", row))
    )
    scenes = tuple(SceneRef(f"s{i}", i) for i in (0, 1))
    here, other = (Library("ten", scenes, digest) for digest in ("hash", "other"))
    cases = (
        (one, here, 4, "fingerprint"),
        (one, here, 1, "fingerprint"),  # the size of blocks decides none
        (other_treatment, here, 4, "fingerprint"),
        (other_scene, here, 4, "fingerprint"),
        (one, other, 4, "fingerprint"),
        (one, here, 4, "another"),
    )
    keys = [units_of(*case)[0].key for case in cases]
    assert keys[0] == keys[1]
    assert len(set(keys)) == 5
