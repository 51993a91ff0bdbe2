"""`faultpath scan`: files, words, what resumes, and what is refused."""

import json
import shlex
import signal
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
from cli_runs import HERE, TOY, edit, faultpath, flags, shards, start, until

import faultpath as library
from faultpath.analyses.scan.record import ScanRecord

SLOW = f"{HERE / 'systems' / 'slow_toy.py'}:create"


def line(folder: Path, *more: object, **options: object) -> list[object]:
    """Return the command of a scan of the toy, with some options changed."""
    question: dict[str, object] = {"system": TOY, "variant": "calibrated", "library": "carts"}
    question |= {"fault": "gain:scale=1.2", "workers": 0, "out": folder / "run"} | options
    return ["scan", question.pop("system"), *flags(question), *more]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scan")
    ended = faultpath(*line(folder, repair="blind"))
    assert (ended.status, ended.err) == (0, "")
    assert "4 errors alone in 50 scenes first, 500 trials" in ended.out
    assert str(folder / "run" / "report.html") in ended.out
    (command,) = {row for row in ended.out.splitlines() if row.endswith("gain:scale=1.2")}
    assert shlex.split(command)[1:4] == ["faultpath", "audit", TOY]
    return folder / "run"


class _Texts(HTMLParser):
    def __init__(self, page: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.feed(page)

    def handle_data(self, data: str) -> None:
        self.texts.append(" ".join(data.split()))


def _record(run: Path) -> ScanRecord:
    record = library.open_run(run).record
    assert isinstance(record, ScanRecord)
    return record


def test_the_toys_shared_gain_cancels_and_the_repair_has_no_such_pair(run: Path) -> None:
    record = _record(run)
    calibrated, blind = record.versions
    pairs = [tuple(record.errors[e].text for e in pair.errors) for pair in calibrated.listed]
    assert pairs == [
        ("gain:scale=0.8@controller", "gain:scale=0.8@observer"),
        ("gain:scale=1.2@controller", "gain:scale=1.2@observer"),
    ]
    assert [pair.kind for pair in calibrated.listed] == ["cancel", "cancel"]
    assert blind.listed == ()


def test_the_page_shows_every_listed_pair_and_nothing_moves_sideways(run: Path) -> None:
    record = _record(run)
    page = (run / "report.html").read_text()
    texts = " ".join(" ".join(_Texts(page).texts).split())
    assert record.headline.split(", ")[1] in texts
    for version in record.versions:
        for pair in version.listed:
            assert f"{pair.both:.0f} % with both, {pair.none:.0f} % with neither" in texts
    for command in record.commands:
        assert command in texts
    pictures = page.count('role="img"')
    assert pictures == 2 + 2, "a triangle a version, and a strip a listed pair"
    assert page.count("<desc") == pictures
    for name in ("scan.svg", "scan-2.svg"):
        assert ElementTree.fromstring((run / name).read_text()).tag.endswith("svg")
    (run / "scan.svg").unlink()
    assert faultpath("report", run).status == 0
    assert (run / "scan.svg").exists()


def test_a_scan_that_is_killed_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    (gate := tmp_path / "gate").touch()
    options = {"system": SLOW, "set": f"gate={gate}", "scenes": 59, "fault": "gain:scale=1.4"}
    run, whole = tmp_path / "run", tmp_path / "whole"
    for count, stop in ((2, signal.SIGKILL), (130, signal.SIGINT)):
        process = start(tmp_path / "words", *line(tmp_path, **options))
        until(lambda count=count: len(shards(run)) >= count, f"{count} blocks")
        gate.touch()
        process.send_signal(stop)
        process.wait(timeout=60)
        assert not (run / "scan.json").exists()
        gate.unlink()
    assert "again to resume" in (tmp_path / "words").read_text()
    for folder in (run, whole):
        assert faultpath(*line(tmp_path, **options | {"out": folder})).status == 0
    for name in ("scan.json", "outcomes.parquet", "table.md"):
        assert (run / name).read_bytes() == (whole / name).read_bytes()


def test_without_trials_the_sources_are_ranked_and_nothing_is_written(tmp_path: Path) -> None:
    ended = faultpath(*line(tmp_path, "--no-trials", "--json"))
    assert (ended.status, ended.err) == (0, "")
    ranking = json.loads(ended.out)
    first = ranking["sources"][0]
    assert (first["name"], first["fault"], first["rank"]) == ("gain_estimate", "gain:scale=1.2", 1)
    assert "1 gain_estimate" in faultpath(*line(tmp_path, "--no-trials")).out
    assert not (tmp_path / "run").exists()


def test_a_changed_result_is_refused(run: Path) -> None:
    path = run / "scan.json"
    before = path.read_bytes()
    try:
        edit(path, lambda record: record.update(failed=1))
        faultpath("report", run).refused("scan.json changed since the run")
    finally:
        path.write_bytes(before)


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"fault": "gain:scale"}, ("gain:scale", "needs one size")),
        ({"scenes": "many"}, ("--scenes", "'many'")),
        ({"scenes": 51}, ("51 scenes of 'carts' are too few",)),
        ({"variant": "calibratd"}, ("did you mean 'calibrated'",)),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    options: dict[str, object], names: tuple[str, ...], tmp_path: Path
) -> None:
    faultpath(*line(tmp_path, **options)).refused(*names)
    assert not (tmp_path / "run").exists()
