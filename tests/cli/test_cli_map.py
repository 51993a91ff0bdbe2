"""`faultpath map` from end to end: its files, its words, and what is left after it was stopped."""

import json
import signal
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from cli_runs import HERE, TOY, faultpath, shards, until

import faultpath as library
from faultpath.decisions.map.model import MapRecord

SLOW = f"{HERE / 'systems' / 'slow_toy.py'}:create"
FILES = ("map.json", "outcomes.parquet", "report.html", "map.svg", "correlation.svg", "table.md")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def line(out: Path, system: str = TOY, scenes: int = 8, **options: object) -> list[object]:
    given = {
        "baseline": "calibrated",
        "repair": "blind",
        "fault": "gain",
        "against": "controller,observer",
        "up-to": 0.4,
        "points": 30,
        "library": "carts",
        "scenes": scenes,
        "workers": 0,
        "out": out,
    } | options
    return ["map", system, *(part for k, v in given.items() for part in (f"--{k}", v))]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("map") / "run"
    ended = faultpath(*line(folder, scenes=12))
    assert (ended.status, ended.err) == (0, "")
    assert "25 pairs of errors first, 600 trials" in ended.out
    assert "Sharing the error reverses" in ended.out or "nothing is significant" in ended.out
    assert str(folder / "report.html") in ended.out
    return folder


def record_of(folder: Path) -> MapRecord:
    return MapRecord.model_validate_json((folder / "map.json").read_bytes())


def test_a_map_leaves_its_record_pictures_and_page(run: Path) -> None:
    assert {path.name for path in run.iterdir()} >= {*FILES, "provenance.json", "manifest.json"}
    record = record_of(run)
    page = (run / "report.html").read_text()
    assert record.headline in page
    for name in ("map.svg", "correlation.svg"):
        text = (run / name).read_text()
        root = ElementTree.fromstring(text)
        assert root.tag.endswith("svg")
    circles = (run / "map.svg").read_text().count("<circle")
    assert circles == len(record.points) + 2, "two in the key"
    assert len(record.points) >= 25
    assert "shared" in (run / "table.md").read_text()
    provenance = json.loads((run / "provenance.json").read_text())
    assert provenance["blocks_kept"] == 0
    assert provenance["blocks_computed"] == len(shards(run))


def test_the_pages_are_made_again_and_a_changed_record_is_refused(
    run: Path, tmp_path: Path
) -> None:
    (run / "map.svg").unlink()
    opened = library.open_run(run)
    assert opened.record == record_of(run)
    assert faultpath("report", run).status == 0
    assert (run / "map.svg").exists()
    text = (run / "map.json").read_text()
    try:
        (run / "map.json").write_text(text.replace('"sign": 0', '"sign": 1', 1))
        assert "map.json changed since the run" in faultpath("report", run).refused()
    finally:
        (run / "map.json").write_text(text)


def test_a_map_that_is_killed_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    gate = tmp_path / "gate"
    gate.touch()
    options = {"system": SLOW, "set": f"gate={gate}", "points": 25, "scenes": 4}
    command = [sys.executable, "-c", "from faultpath.cli.main import main; main()"]
    for stop in (signal.SIGKILL, signal.SIGINT):
        with (tmp_path / "words").open("w") as words:
            arguments = [str(part) for part in line(tmp_path / "run", **options)]
            process = subprocess.Popen(
                [*command, *arguments], stdout=words, stderr=words, start_new_session=True
            )
        have = len(shards(tmp_path / "run"))
        until(lambda have=have: len(shards(tmp_path / "run")) >= have + 2, "two blocks")
        process.send_signal(stop)
        process.wait(timeout=60)
        assert not (tmp_path / "run" / "map.json").exists()
    assert "again to resume" in (tmp_path / "words").read_text()
    gate.unlink()
    assert faultpath(*line(tmp_path / "run", **options)).status == 0
    assert faultpath(*line(tmp_path / "whole", **options)).status == 0
    for name in ("map.json", "outcomes.parquet", "table.md"):
        assert (tmp_path / "run" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"spread": "wide"}, "--spread: 'wide' is not a list of numbers"),
        ({"mean": "0.1,x"}, "--mean: '0.1,x' is not a list of numbers"),
        ({"against": "controller"}, "--against needs two modules"),
        ({"fault": "gain:scale=0.6"}, "leave '=0.6' out"),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    options: dict[str, object], said: str, tmp_path: Path
) -> None:
    assert said in faultpath(*line(tmp_path / "run", **options)).refused()
    assert not (tmp_path / "run").exists()
