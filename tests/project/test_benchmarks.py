"""The page on performance says what was measured, and what was measured is complete."""

import json
from dataclasses import replace
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
    import benchmarks.table

    return benchmarks


def shown(benchmarks, results) -> str:
    return "\n\n".join(benchmarks.page.rows(results, *benchmarks.table.COMPARISONS))


def test_every_record_is_named_once_and_shown(benchmarks):
    results = benchmarks.results.load()
    names = [record.name for record in results.records]
    assert len(set(names)) == len(names)
    assert {record.comparison for record in results.records} == set(benchmarks.table.COMPARISONS)
    text = (ROOT / "docs" / "performance.md").read_text("utf-8")
    page = text.replace("\\", "").replace("&lt;", "<")
    assert all(name in page for name in names)


def test_every_row_of_the_table_names_sides_that_run(benchmarks):
    for contest in benchmarks.table.CONTESTS.values():
        assert set(contest.sides) >= {side for row in contest.rows for side in (row.ours, row.peer)}
        assert set(contest.sides) >= {*contest.same, *contest.same.values()}


def test_every_record_has_its_numbers_or_says_why_not(benchmarks):
    for record in benchmarks.results.load().records:
        if record.ours is None:
            assert record.note.startswith("Not measured: ")
            assert record.met is None
        else:
            assert record.unit
            assert (record.peer is None) == (record.ratio is None)
            assert (record.target is None) == (record.met is None)
            assert record.judged() == record


def test_the_documents_fields_are_those_that_readers_expect():
    content = json.loads((ROOT / "benchmarks" / "results.json").read_text())
    assert set(content) == {"machine", "records", "curves", "apart", "editions"}
    expected = {"name", "ours", "peer", "ratio", "unit", "target", "met", "low", "high", "note"}
    assert all(expected <= set(record) for record in content["records"])
    for machine in (content["machine"], *content["apart"].values()):
        assert {"processor", "cores", "memory_gib", "commit"} <= set(machine)


def test_a_comparison_taken_by_itself_names_its_own_machine(benchmarks):
    results = benchmarks.results.load()
    here = results.machine.model_copy(update={"commit": "f" * 40})
    kept = [record for record in results.records if record.comparison == "plant"]
    alone = results.replaced(here, "plant", kept, apart=True)
    assert alone.machine == results.machine
    assert "ffffffffffff" in shown(benchmarks, alone)
    together = alone.replaced(here, "plant", kept, apart=False)
    assert together.machine == here
    assert "plant" not in together.apart


def test_numbers_of_an_earlier_edition_are_said_to_be_out_of_date(benchmarks, monkeypatch):
    results, name = benchmarks.results.load(), "depth"
    first = benchmarks.table.COMPARISONS[name]
    later = replace(first, edition=first.edition + 1, changed="its rays go further")
    monkeypatch.setitem(benchmarks.table.COMPARISONS, name, later)
    outdated = 'its rays go further. `make bench ARGS="--only depth"`'
    assert outdated in shown(benchmarks, results)
    kept = [record for record in results.records if record.comparison == name]
    again = results.replaced(results.machine, name, kept, True, later.edition)
    assert outdated not in shown(benchmarks, again)


def test_a_ratio_is_formed_within_each_round(benchmarks):
    rates = benchmarks.measure.Rates({"a": [10.0, 20.0, 40.0], "b": [5.0, 5.0, 40.0]}, {})
    row = benchmarks.comparison.Row("x", "a", "b", benchmarks.results.at_least(2.5))
    record = row.record(rates, "1/s")
    assert (record.ours, record.peer) == (20.0, 5.0)
    assert (record.ratio, record.low, record.high) == (2.0, 1.0, 4.0)
    assert record.met is False
    times = row.record(rates, "ms")
    assert (times.ours, times.ratio) == (50.0, 2.0)


def test_a_side_that_cannot_be_built_is_left_out_with_its_reason(benchmarks):
    work = benchmarks.measure.Work("benchmarks.nowhere:side")
    rates = benchmarks.measure.interleaved({"a": work}, rounds=1)
    assert "nowhere" in rates.missing["a"]
    record = benchmarks.comparison.Row("x", "a", "b").record(rates, "1/s")
    assert record.ours is None
    assert "nowhere" in record.note


def test_a_case_that_fails_does_not_lose_the_others(benchmarks):
    def fails(effort):
        raise RuntimeError("no scene")

    def works(effort):
        yield benchmarks.results.record("good", "s", [1.0, 3.0, 2.0])

    comparison = benchmarks.comparison.Comparison("x", {"bad": fails, "good": works})
    bad, good = comparison.take(benchmarks.comparison.Effort())
    assert (bad.name, bad.note) == ("bad", "Not measured: RuntimeError: no scene")
    assert (good.ours, good.low, good.high) == (2.0, 1.0, 3.0)


def test_the_bootstrap_that_is_timed_gives_one_interval_with_and_without_its_draw(benchmarks):
    from benchmarks import bootstrap

    assert bootstrap.ours(drawn=True).answer() == bootstrap.ours().answer()


def test_the_model_that_peers_are_given_is_ours(benchmarks):
    from benchmarks.peers import rows
    from benchmarks.planning import rollout

    ours, theirs = rollout().answer(), rows.positions(rows.RowsModel())
    assert max(abs(a - b) for a, b in zip(ours, theirs, strict=True)) < 1e-3
