"""`faultpath sensitivity` from end to end: its files, its words, what resumes, what is refused."""

import json
import sys
from pathlib import Path

import pytest
from cli_runs import TOY, faultpath, flags, shards

import faultpath as library


def line(folder: Path, *more: object, **options: object) -> list[object]:
    asked: dict[str, object] = {
        "variant": "calibrated",
        "metric": "terminal_distance_m",
        "scenes": 2,
        "library": "carts",
        "workers": 0,
        "out": folder / "run",
    }
    faults = ("--fault", "gain:scale=1.05", "--fault", "velocity:offset=0.5")
    return ["sensitivity", TOY, *faults, *flags(asked | options), *more]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sensitivity")
    ended = faultpath(*line(folder))
    assert (ended.status, ended.err) == (0, "")
    assert "64 points of 2 groups of sources: 512 trials at most." in ended.out
    assert "Alone, speedometer explains more than any other source" in ended.out
    assert str(folder / "run" / "report.html") in ended.out
    return folder / "run"


def test_what_is_written_is_what_was_decided(run: Path) -> None:
    opened = library.open_run(run)
    record = opened.record
    assert [each.group for each in record.indices] == ["gain_estimate", "speedometer"]
    gain, speed = (each.first for each in record.indices)
    assert speed.low > max(0.5, gain.high)
    assert len(record.values) == 64 * 4
    page, rows = (run / "report.html").read_text(), (run / "sensitivity.csv").read_text()
    opened.report()
    assert (run / "report.html").read_text() == page
    assert record.headline in page
    assert page.count('class="dot open"') == 2
    assert rows.splitlines()[0] == "Source,Error,Alone (first-order),With others (total)"
    assert rows.splitlines()[2].startswith("speedometer,±0.5,")
    assert json.loads((run / "sensitivity.json").read_text())["question"]["points"] == 64


def test_what_is_lost_is_run_again_to_the_same_bytes(run: Path) -> None:
    names = ("sensitivity.json", "outcomes.parquet", "table.md")
    before = [(run / name).read_bytes() for name in names]
    lost = shards(run)[::9]
    for shard in (*lost, run / "sensitivity.json"):
        shard.unlink()
    assert faultpath(*line(run.parent)).status == 0
    assert [(run / name).read_bytes() for name in names] == before
    assert library.open_run(run).provenance.blocks_computed == len(lost)


def test_a_mistake_is_one_sentence_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for options, names in (
        ({"points": 100}, ("--points", "100", "64 or 128")),
        ({"points": 32}, ("--points", "32", "64")),
        ({"variant": "calibrate"}, ("'calibrated'",)),
        ({"metric": "speed"}, ("'speed'",)),
        ({"scenes": 1000}, ("1 to 100",)),
    ):
        faultpath(*line(tmp_path, **options)).refused(*names)
    faultpath(*line(tmp_path, "--fault", "gain")).refused("--fault gain")
    faultpath("sensitivity", TOY, "--variant", "blind", "--fault", "gain:scale=1.1").refused(
        "blind", "gain_estimate"
    )
    monkeypatch.setitem(sys.modules, "SALib.sample", None)
    faultpath(*line(tmp_path)).refused("pip install '.[sensitivity]'")
    assert not (tmp_path / "run").exists()
