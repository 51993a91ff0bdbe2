"""`faultpath search` from end to end: its files, its words, what resumes, and what is refused."""

import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from cli_runs import TOY, edit, faultpath, flags, shards

import faultpath as library

BOUNDS = "isolated: observer\nfaults:\n- {fault: gain, size: [0.6, 1.4]}\n"


def line(folder: Path, **options: object) -> list[object]:
    (folder / "bounds.yaml").write_text(BOUNDS)
    asked: dict[str, object] = {
        "baseline": "calibrated",
        "repair": "blind",
        "within": folder / "bounds.yaml",
        "candidates": 12,
        "library": "carts",
        "scenes": 80,
        "workers": 0,
        "out": folder / "run",
    }
    return ["search", TOY, *flags(asked | options)]


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
    record, page = library.open_run(run).record, (run / "report.html").read_text()
    library.open_run(run).report()
    assert (run / "report.html").read_text() == page
    confirming = library.open_run(run / record.confirmation)
    assert confirming.record == record.confirmed
    assert confirming.record.question.fault == record.best
    assert record.best == max(record.tried, key=lambda tried: tried.regret_pp).fault
    tables = (confirming.table(), pq.read_table(run / "outcomes.parquet"))
    ours, theirs = (set(table.column("scene").to_pylist()) for table in tables)
    assert (len(ours), len(theirs), len(ours & theirs)) == (40, 40, 0)
    page = (run / "report.html").read_text()
    assert record.headline in page
    assert f'href="{record.confirmation}/report.html"' in page
    assert (run / "tried.svg").read_text().count('class="dot open"') == len(record.tried)


def test_what_is_lost_is_run_again_to_the_same_bytes(run: Path) -> None:
    names = ("search.json", "outcomes.parquet", "table.md")
    before = [(run / name).read_bytes() for name in names]
    lost, confirming = shards(run)[::2], run / library.open_run(run).record.confirmation
    for shard in (*lost, *shards(confirming)[:1], run / "search.json"):
        shard.unlink()
    assert faultpath(*line(run.parent)).status == 0
    assert [(run / name).read_bytes() for name in names] == before
    assert library.open_run(run).provenance.blocks_computed == len(lost)


def test_a_changed_record_is_refused(run: Path) -> None:
    before = (run / "search.json").read_bytes()
    try:
        edit(run / "search.json", lambda record: record.update(failed=1))
        faultpath("report", run).refused("search.json changed since the run")
    finally:
        (run / "search.json").write_bytes(before)


def test_a_mistake_is_one_sentence_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    faultpath(*line(tmp_path, within=tmp_path / "none.yaml")).refused("none.yaml")
    faultpath(*line(tmp_path, candidates=3)).refused("--candidates", "3", "8")
    faultpath(*line(tmp_path, scenes=1)).refused("2 --scenes")
    monkeypatch.setitem(sys.modules, "cmaes", None)
    faultpath(*line(tmp_path)).refused("pip install '.[search]'")
    assert not (tmp_path / "run").exists()
