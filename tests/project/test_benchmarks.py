"""The page on performance says what was measured, and what was measured is complete."""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def benchmarks(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(ROOT))
    import benchmarks.comparison
    import benchmarks.measure
    import benchmarks.page
    import benchmarks.results

    return benchmarks


def test_every_record_is_named_once_and_shown(benchmarks):
    results = benchmarks.results.load()
    names = [record.name for record in results.records]
    assert len(set(names)) == len(names)
    shown = {name for section in benchmarks.page.SECTIONS for name in section.comparisons}
    assert {record.comparison for record in results.records} == shown
    page = benchmarks.page.text(results).replace("\\", "").replace("&lt;", "<")
    assert all(name in page for name in names)


def test_every_record_has_its_numbers_or_says_why_not(benchmarks):
    for record in benchmarks.results.load().records:
        if record.ours is None:
            assert record.note.startswith("Not measured: ")
            assert record.met is None
        else:
            assert record.unit
            assert (record.peer is None) == (record.ratio is None)
            assert (record.target is None) == (record.met is None)
            assert benchmarks.comparison.judged(record) == record


def test_the_documents_fields_are_those_that_readers_expect():
    content = json.loads((ROOT / "benchmarks" / "results.json").read_text())
    assert set(content) == {"machine", "records", "curves", "apart"}
    expected = {"name", "ours", "peer", "ratio", "unit", "target", "met", "low", "high", "note"}
    assert all(expected <= set(record) for record in content["records"])
    for machine in (content["machine"], *content["apart"].values()):
        assert {"processor", "cores", "memory_gib", "commit"} <= set(machine)


def test_a_comparison_taken_by_itself_names_its_own_machine(benchmarks):
    results = benchmarks.results.load()
    here = results.machine.model_copy(update={"commit": "f" * 40})
    kept = [record for record in results.records if record.comparison == "plant"]
    alone = results.replaced(here, "plant", kept, (), apart=True)
    assert alone.machine == results.machine
    assert "ffffffffffff" in benchmarks.page.text(alone)
    together = alone.replaced(here, "plant", kept, (), apart=False)
    assert together.machine == here
    assert "plant" not in together.apart


def test_a_ratio_is_formed_within_each_round(benchmarks):
    rates = benchmarks.measure.Rates({"a": [10.0, 20.0, 40.0], "b": [5.0, 5.0, 40.0]}, {})
    writer = benchmarks.comparison.Writer("x", rates)
    record = writer.versus("x", "a", "b", "1/s", benchmarks.comparison.at_least(2.5))
    assert (record.ours, record.peer) == (20.0, 5.0)
    assert (record.ratio, record.low, record.high) == (2.0, 1.0, 4.0)
    assert record.met is False
    times = writer.versus("x", "a", "b", "ms")
    assert (times.ours, times.ratio) == (50.0, 2.0)


def test_a_side_that_cannot_be_built_is_left_out_with_its_reason(benchmarks):
    work = benchmarks.measure.Work("benchmarks.nowhere:Side")
    rates = benchmarks.measure.interleaved({"a": work}, rounds=1)
    assert "nowhere" in rates.missing["a"]
    record = benchmarks.comparison.Writer("x", rates).versus("x", "a", "b", "1/s")
    assert record.ours is None
    assert "nowhere" in record.note


def test_the_bootstrap_that_is_timed_gives_one_interval_with_and_without_its_draw(benchmarks):
    from benchmarks import statistics_side

    assert statistics_side.Ours(drawn=True).answer() == statistics_side.Ours().answer()


def test_the_model_that_peers_are_given_is_ours(benchmarks):
    from benchmarks.peers import rows
    from benchmarks.planner import Rollout

    ours, theirs = Rollout().answer(), rows.positions(rows.RowsModel())
    assert max(abs(a - b) for a, b in zip(ours, theirs, strict=True)) < 1e-3
