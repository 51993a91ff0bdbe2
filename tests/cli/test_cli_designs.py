"""`faultpath map`: files, words, what resumes, and what is refused."""

import signal
from pathlib import Path
from xml.etree import ElementTree

import pytest
from cli_runs import HERE, TOY, edit, faultpath, flags, shards, start, until

import faultpath as library

SLOW = f"{HERE / 'systems' / 'slow_toy.py'}:create"


def line(folder: Path, **options: object) -> list[object]:
    """Return the command of a map of the toy, with some options changed."""
    question: dict[str, object] = {"system": TOY, "baseline": "calibrated", "repair": "blind"}
    question |= {"library": "carts", "workers": 0, "out": folder / "run", "fault": "gain"}
    question |= {"against": "controller,observer", "up-to": 0.4, "points": 30, "scenes": 12}
    question |= options
    return ["map", question.pop("system"), *flags(question)]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("map")
    ended = faultpath(*line(folder))
    assert (ended.status, ended.err) == (0, "")
    assert "25 pairs of errors first, 600 trials" in ended.out
    assert str(folder / "run" / "report.html") in ended.out
    return folder / "run"


def test_a_map_leaves_its_record_pictures_and_page(run: Path) -> None:
    record = library.open_run(run).record
    assert record.headline in (run / "report.html").read_text()
    for name in ("map.svg", "correlation.svg"):
        assert ElementTree.fromstring((run / name).read_text()).tag.endswith("svg")
    circles = (run / "map.svg").read_text().count("<circle")
    assert circles == len(record.points) + 2, "two in the key"
    (run / "map.svg").unlink()
    assert faultpath("report", run).status == 0
    assert (run / "map.svg").exists()


def test_a_map_that_is_killed_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    (gate := tmp_path / "gate").touch()
    options = {"system": SLOW, "set": f"gate={gate}", "points": 25, "scenes": 2}
    run, whole = tmp_path / "run", tmp_path / "whole"
    for stop in (signal.SIGKILL, signal.SIGINT):
        process = start(tmp_path / "words", *line(tmp_path, **options))
        have = len(shards(run))
        until(lambda have=have: len(shards(run)) >= have + 2, "two blocks")
        process.send_signal(stop)
        process.wait(timeout=60)
        assert not (run / "map.json").exists()
    assert "again to resume" in (tmp_path / "words").read_text()
    gate.unlink()
    for folder in (run, whole):
        assert faultpath(*line(tmp_path, out=folder, **options)).status == 0
    for name in ("map.json", "outcomes.parquet", "table.md"):
        assert (run / name).read_bytes() == (whole / name).read_bytes()


def test_a_changed_record_is_refused(run: Path) -> None:
    path = run / "map.json"
    before = path.read_bytes()
    try:
        edit(path, lambda record: record.update(failed=1))
        faultpath("report", run).refused("map.json changed since the run")
    finally:
        path.write_bytes(before)


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"spread": "wide"}, ("--spread", "'wide'")),
        ({"mean": "0.1,x"}, ("--mean", "'0.1,x'")),
        ({"against": "controller,,observer"}, ("--against", "empty name")),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    options: dict[str, object], names: tuple[str, ...], tmp_path: Path
) -> None:
    faultpath(*line(tmp_path, **options)).refused(*names)
    assert not (tmp_path / "run").exists()
