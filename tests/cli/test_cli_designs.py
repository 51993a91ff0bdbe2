"""`faultpath map`, `search` and `sensitivity`: files, words, what resumes, and what is refused."""

import signal
import sys
from pathlib import Path
from xml.etree import ElementTree

import pyarrow.parquet as pq
import pytest
from cli_runs import HERE, TOY, edit, faultpath, flags, shards, start, until

import faultpath as library

SLOW = f"{HERE / 'systems' / 'slow_toy.py'}:create"
BOUNDS = "isolated: observer\nfaults:\n- {fault: gain, size: [0.6, 1.4]}\n"
VERBS = ("map", "search", "sensitivity")
SAID = {
    "map": ("25 pairs of errors first, 600 trials",),
    "search": (
        "12 faults are tried in 40 scenes",
        "A reversal was confirmed at gain:scale=",
    ),
    "sensitivity": (
        "64 points of 2 groups of sources: 256 trials at most.",
        "Alone, speedometer explains more than any other source",
    ),
}


def line(verb: str, folder: Path, **options: object) -> list[object]:
    (folder / "bounds.yaml").write_text(BOUNDS)
    arms = {"baseline": "calibrated", "repair": "blind"}
    own: dict[str, dict[str, object]] = {
        "map": {**arms, "fault": "gain", "against": "controller,observer", "up-to": 0.4}
        | {"points": 30, "scenes": 12},
        "search": {**arms, "within": folder / "bounds.yaml", "candidates": 12, "scenes": 80},
        "sensitivity": {"variant": "calibrated", "metric": "terminal_distance_m", "scenes": 1},
    }
    faults = ("--fault", "gain:scale=1.05", "--fault", "velocity:offset=0.5")
    question = {"system": TOY, "library": "carts", "workers": 0, "out": folder / "run"}
    question |= own[verb] | options
    system, default = question.pop("system"), verb == "sensitivity" and "fault" not in question
    return [verb, system, *(faults if default else ()), *flags(question)]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folders = {verb: tmp_path_factory.mktemp(verb) for verb in VERBS}
    for verb, folder in folders.items():
        ended = faultpath(*line(verb, folder))
        assert (ended.status, ended.err) == (0, "")
        assert all(words in ended.out for words in SAID[verb])
        assert str(folder / "run" / "report.html") in ended.out
    return {verb: folder / "run" for verb, folder in folders.items()}


def test_a_map_leaves_its_record_pictures_and_page(runs: dict[str, Path]) -> None:
    run = runs["map"]
    record = library.open_run(run).record
    assert record.headline in (run / "report.html").read_text()
    for name in ("map.svg", "correlation.svg"):
        assert ElementTree.fromstring((run / name).read_text()).tag.endswith("svg")
    circles = (run / "map.svg").read_text().count("<circle")
    assert circles == len(record.points) + 2, "two in the key"
    (run / "map.svg").unlink()
    assert faultpath("report", run).status == 0
    assert (run / "map.svg").exists()


def test_what_a_search_confirms_is_an_audit_in_scenes_that_found_nothing(
    runs: dict[str, Path],
) -> None:
    run = runs["search"]
    record = library.open_run(run).record
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


def test_a_sensitivity_analysis_writes_what_was_decided(runs: dict[str, Path]) -> None:
    run = runs["sensitivity"]
    record = library.open_run(run).record
    gain, speed = record.indices
    assert (gain.group, speed.group) == ("gain_estimate", "speedometer")
    assert speed.first.low > max(0.5, gain.first.high)
    page, rows = (run / "report.html").read_text(), (run / "sensitivity.csv").read_text()
    assert record.headline in page
    assert page.count('class="dot open"') == 2
    assert rows.splitlines()[0] == "Source,Error,Alone (first-order),With others (total)"
    assert rows.splitlines()[2].startswith("speedometer,±0.5,")


@pytest.mark.parametrize("verb", ["search", "sensitivity"])
def test_what_is_lost_is_run_again_to_the_same_bytes(verb: str, runs: dict[str, Path]) -> None:
    run = runs[verb]
    names = (f"{verb}.json", "outcomes.parquet", "table.md")
    before = [(run / name).read_bytes() for name in names]
    lost = shards(run)[::4]
    if verb == "search":
        shards(run / library.open_run(run).record.confirmation)[0].unlink()
    for path in (*lost, run / f"{verb}.json"):
        path.unlink()
    assert faultpath(*line(verb, run.parent)).status == 0
    assert [(run / name).read_bytes() for name in names] == before
    assert library.open_run(run).provenance.blocks_computed == len(lost)


def test_a_map_that_is_killed_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    (gate := tmp_path / "gate").touch()
    options = {"system": SLOW, "set": f"gate={gate}", "points": 25, "scenes": 2}
    run, whole = tmp_path / "run", tmp_path / "whole"
    for stop in (signal.SIGKILL, signal.SIGINT):
        process = start(tmp_path / "words", *line("map", tmp_path, **options))
        have = len(shards(run))
        until(lambda have=have: len(shards(run)) >= have + 2, "two blocks")
        process.send_signal(stop)
        process.wait(timeout=60)
        assert not (run / "map.json").exists()
    assert "again to resume" in (tmp_path / "words").read_text()
    gate.unlink()
    for folder in (run, whole):
        assert faultpath(*line("map", tmp_path, out=folder, **options)).status == 0
    for name in ("map.json", "outcomes.parquet", "table.md"):
        assert (run / name).read_bytes() == (whole / name).read_bytes()


@pytest.mark.parametrize("verb", VERBS)
def test_a_changed_record_is_refused(verb: str, runs: dict[str, Path]) -> None:
    path = runs[verb] / f"{verb}.json"
    before = path.read_bytes()
    try:
        edit(path, lambda record: record.update(failed=1))
        faultpath("report", runs[verb]).refused(f"{verb}.json changed since the run")
    finally:
        path.write_bytes(before)


@pytest.mark.parametrize(
    ("verb", "options", "names"),
    [
        ("map", {"spread": "wide"}, ("--spread", "'wide'")),
        ("map", {"mean": "0.1,x"}, ("--mean", "'0.1,x'")),
        ("map", {"against": "controller,,observer"}, ("--against", "empty name")),
        ("search", {"within": "none.yaml"}, ("none.yaml",)),
        ("search", {"candidates": 3}, ("--candidates", "3", "8")),
        ("search", {"scenes": 1}, ("2 --scenes",)),
        ("search", {}, ("pip install '.[search]'",)),
        ("sensitivity", {"points": 100}, ("--points", "100", "64 or 128")),
        ("sensitivity", {"points": 32}, ("--points", "32", "64")),
        ("sensitivity", {"metric": "speed"}, ("'speed'",)),
        ("sensitivity", {"variant": "blind", "fault": "gain:scale=2"}, ("blind", "gain_estimate")),
        ("sensitivity", {"fault": "gain"}, ("--fault gain",)),
        ("sensitivity", {}, ("pip install '.[sensitivity]'",)),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    verb: str,
    options: dict[str, object],
    names: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if not options:
        missing = {"search": "cmaes", "sensitivity": "SALib.sample"}[verb]
        monkeypatch.setitem(sys.modules, missing, None)
    faultpath(*line(verb, tmp_path, **options)).refused(*names)
    assert not (tmp_path / "run").exists()
