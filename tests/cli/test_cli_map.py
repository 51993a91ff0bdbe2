"""`faultpath map` from end to end: its files, its words, and what is left after it was stopped."""

import json
import signal
from pathlib import Path
from xml.etree import ElementTree

import pytest
from cli_runs import HERE, TOY, edit, faultpath, flags, shards, start, until

import faultpath as library

SLOW = f"{HERE / 'systems' / 'slow_toy.py'}:create"
FILES = ("map.json", "outcomes.parquet", "report.html", "map.svg", "correlation.svg", "table.md")


def line(out: Path, system: str = TOY, **options: object) -> list[object]:
    asked: dict[str, object] = {
        "baseline": "calibrated",
        "repair": "blind",
        "fault": "gain",
        "against": "controller,observer",
        "up-to": 0.4,
        "points": 30,
        "library": "carts",
        "scenes": 8,
        "workers": 0,
        "out": out,
    }
    return ["map", system, *flags(asked | options)]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("map") / "run"
    ended = faultpath(*line(folder, scenes=12))
    assert (ended.status, ended.err) == (0, "")
    assert "25 pairs of errors first, 600 trials" in ended.out
    assert "Sharing the error reverses" in ended.out or "nothing is significant" in ended.out
    assert str(folder / "report.html") in ended.out
    return folder


def test_a_map_leaves_its_record_pictures_and_page(run: Path) -> None:
    assert {path.name for path in run.iterdir()} >= {*FILES, "provenance.json", "manifest.json"}
    record, page = library.open_run(run).record, (run / "report.html").read_text()
    assert record.headline in page
    library.open_run(run).report()
    assert (run / "report.html").read_text() == page
    for name in ("map.svg", "correlation.svg"):
        assert ElementTree.fromstring((run / name).read_text()).tag.endswith("svg")
    circles = (run / "map.svg").read_text().count("<circle")
    assert circles == len(record.points) + 2, "two in the key"
    assert len(record.points) >= 25
    assert "shared" in (run / "table.md").read_text()
    provenance = json.loads((run / "provenance.json").read_text())
    assert provenance["blocks_kept"] == 0
    assert provenance["blocks_computed"] == len(shards(run))


def test_the_pages_are_made_again_and_a_changed_record_is_refused(run: Path) -> None:
    (run / "map.svg").unlink()
    assert faultpath("report", run).status == 0
    assert (run / "map.svg").exists()
    before = (run / "map.json").read_bytes()
    try:
        edit(run / "map.json", lambda record: record["points"][0].update(sign=1))
        faultpath("report", run).refused("map.json changed since the run")
    finally:
        (run / "map.json").write_bytes(before)


def test_a_map_that_is_killed_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    (gate := tmp_path / "gate").touch()
    options = {"system": SLOW, "set": f"gate={gate}", "points": 25, "scenes": 2}
    run, whole = tmp_path / "run", tmp_path / "whole"
    for stop in (signal.SIGKILL, signal.SIGINT):
        process = start(tmp_path / "words", *line(run, **options))
        have = len(shards(run))
        until(lambda have=have: len(shards(run)) >= have + 2, "two blocks")
        process.send_signal(stop)
        process.wait(timeout=60)
        assert not (run / "map.json").exists()
    assert "again to resume" in (tmp_path / "words").read_text()
    gate.unlink()
    assert faultpath(*line(run, **options)).status == 0
    assert faultpath(*line(whole, **options)).status == 0
    for name in ("map.json", "outcomes.parquet", "table.md"):
        assert (run / name).read_bytes() == (whole / name).read_bytes()


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"spread": "wide"}, ("--spread", "'wide'")),
        ({"mean": "0.1,x"}, ("--mean", "'0.1,x'")),
        ({"against": "controller"}, ("--against", "two modules")),
        ({"against": "controller,,observer"}, ("--against", "empty name")),
        ({"fault": "gain:scale=0.6"}, ("'=0.6'",)),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    options: dict[str, object], names: tuple[str, ...], tmp_path: Path
) -> None:
    faultpath(*line(tmp_path / "run", **options)).refused(*names)
    assert not (tmp_path / "run").exists()
