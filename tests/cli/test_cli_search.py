"""`faultpath search` from end to end: its files, its words, what resumes, and what is refused."""

import sys
from pathlib import Path

import pytest
from cli_runs import TOY, faultpath, shards

import faultpath as library
from faultpath.decisions.search.model import SearchRecord

BOUNDS = "isolated: observer\nfaults:\n- {fault: gain, size: [0.6, 1.4]}\n"


def line(folder: Path, **options: object) -> list[object]:
    (folder / "bounds.yaml").write_text(BOUNDS)
    given = {
        "baseline": "calibrated",
        "repair": "blind",
        "within": folder / "bounds.yaml",
        "candidates": 12,
        "library": "carts",
        "scenes": 80,
        "workers": 0,
        "out": folder / "run",
    } | options
    return ["search", TOY, *(part for k, v in given.items() for part in (f"--{k}", v))]


def record_of(folder: Path) -> SearchRecord:
    return SearchRecord.model_validate_json((folder / "search.json").read_bytes())


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("search")
    ended = faultpath(*line(folder))
    assert (ended.status, ended.err) == (0, "")
    assert "12 faults are tried in 40 scenes" in ended.out
    assert "A reversal was confirmed at gain:scale=" in ended.out
    assert str(folder / "run" / "report.html") in ended.out
    return folder / "run"


def test_what_is_confirmed_is_an_audit_in_scenes_that_found_nothing(run: Path) -> None:
    record = record_of(run)
    confirming = library.open_run(run / record.confirmation)
    assert confirming.record == record.confirmed
    assert (
        confirming.record.question.fault
        == record.best
        == max(record.tried, key=lambda each: each.regret_pp).fault
    )
    table, found = confirming.table(), library.open_run(run)
    assert found.record == record
    import pyarrow.parquet as parquet

    tried = parquet.read_table(run / "outcomes.parquet")
    ours, theirs = (set(each.column("scene").to_pylist()) for each in (table, tried))
    assert (len(ours), len(theirs), len(ours & theirs)) == (40, 40, 0)
    page = (run / "report.html").read_text()
    assert record.headline in page
    assert f'href="{record.confirmation}/report.html"' in page
    assert (run / "tried.svg").read_text().count('class="dot open"') == len(record.tried)


def test_what_is_lost_is_run_again_to_the_same_bytes(run: Path) -> None:
    names = ("search.json", "outcomes.parquet", "table.md")
    before = [(run / name).read_bytes() for name in names]
    lost = shards(run)[::2]
    for shard in (*lost, *shards(run / record_of(run).confirmation)[:1], run / "search.json"):
        shard.unlink()
    assert faultpath(*line(run.parent)).status == 0
    assert [(run / name).read_bytes() for name in names] == before
    assert library.open_run(run).provenance.blocks_computed == len(lost)


def test_a_changed_record_is_refused(run: Path) -> None:
    text = (run / "search.json").read_text()
    try:
        (run / "search.json").write_text(text.replace('"failed": 0', '"failed": 1'))
        assert "search.json changed since the run" in faultpath("report", run).refused()
    finally:
        (run / "search.json").write_text(text)


def test_a_mistake_is_one_sentence_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for options, said in (
        ({"within": tmp_path / "none.yaml"}, "none.yaml: cannot be read"),
        ({"candidates": 3}, "--candidates: is 3, and must be a number of at least 8"),
        ({"scenes": 1}, "give 2 --scenes or more"),
    ):
        assert said in faultpath(*line(tmp_path, **options)).refused()
    monkeypatch.setitem(sys.modules, "cmaes", None)
    assert "pip install '.[search]'" in faultpath(*line(tmp_path)).refused()
    assert not (tmp_path / "run").exists()
