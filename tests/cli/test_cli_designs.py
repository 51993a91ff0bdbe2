"""`faultpath map` and `faultpath scan`: files, words, what resumes, and what is refused."""

import json
import shlex
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from cli_runs import TOY, edit, faultpath, flags, shards

import faultpath as library
from faultpath.analyses.scan.model import ScanResult
from faultpath.cli.main import INTERRUPTED
from faultpath.report.sentences import words
from faultpath.run.store.folder import RunFolder

pytestmark = pytest.mark.slow  # all together

QUESTIONS: dict[str, dict[str, object]] = {
    "map": {"baseline": "calibrated", "repair": "blind", "fault": "gain", "up-to": 0.4}
    | {"against": "controller,observer", "points": 30, "scenes": 4},
    "scan": {"variant": "calibrated", "fault": "gain:scale=1.2"},
}


def line(verb: str, run: Path, *more: object, **options: object) -> list[object]:
    """Return the command of a map or scan of the toy, with some options changed."""
    question = {"library": "carts", "workers": 0, "out": run} | QUESTIONS[verb] | options
    return [verb, TOY, *flags(question), *more]


@pytest.fixture(scope="module")
def map_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    run = tmp_path_factory.mktemp("map") / "run"
    ended = faultpath(*line("map", run))
    assert ended.status == 0, ended.err
    assert "25 pairs of errors first, 200 trials" in ended.err
    assert str(run / "report.html") in ended.out
    return run


@pytest.fixture(scope="module")
def scan_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    run = tmp_path_factory.mktemp("scan") / "run"
    ended = faultpath(*line("scan", run, repair="blind"))
    assert ended.status == 0, ended.err
    assert "4 errors alone in 50 scenes first, 500 trials" in ended.err
    assert str(run / "report.html") in ended.out
    (command,) = {row for row in ended.out.splitlines() if row.endswith("gain:scale=1.2")}
    assert shlex.split(command)[1:4] == ["faultpath", "audit", TOY]
    return run


def test_a_map_leaves_its_record_pictures_and_page(map_run: Path) -> None:
    record = library.open_run(map_run).record
    page = (map_run / "report.html").read_text()
    assert words(record).headline in page
    assert "gain, up to ±40 %" in page
    for name in ("map.svg", "correlation.svg"):
        assert ElementTree.fromstring((map_run / name).read_text()).tag.endswith("svg")
    circles = (map_run / "map.svg").read_text().count("<circle")
    assert circles == len(record.points) + 2, "two in the key"


class _Texts(HTMLParser):
    def __init__(self, page: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.feed(page)

    def handle_data(self, data: str) -> None:
        self.texts.append(" ".join(data.split()))


def test_a_scan_lists_the_pairs_that_cancel_and_its_page_shows_them(scan_run: Path) -> None:
    record = library.open_run(scan_run).record
    assert isinstance(record, ScanResult)
    calibrated, blind = record.versions
    listed = {tuple(record.errors[e].text for e in pair.errors) for pair in calibrated.listed}
    sizes = ("gain:scale=0.8", "gain:scale=1.2")
    assert listed == {(f"{size}@controller", f"{size}@observer") for size in sizes}
    assert [pair.kind for pair in calibrated.listed] == ["cancel", "cancel"]
    assert blind.listed == ()

    page = (scan_run / "report.html").read_text()
    texts = " ".join(" ".join(_Texts(page).texts).split())
    assert words(record).headline.split(", ")[1] in texts
    for pair in calibrated.listed:
        assert f"{pair.both:.0f} % with both, {pair.none:.0f} % with neither" in texts
    assert all(command in texts for command in words(record).commands)
    pictures = page.count('role="img"')
    assert pictures == 2 + 2, "a triangle a version, and a strip a listed pair"
    assert page.count("<desc") == pictures
    for name in ("scan.svg", "scan-2.svg"):
        assert ElementTree.fromstring((scan_run / name).read_text()).tag.endswith("svg")


@pytest.mark.parametrize("verb", QUESTIONS)
def test_a_page_is_made_again_and_a_changed_result_is_refused(
    verb: str, request: pytest.FixtureRequest
) -> None:
    run: Path = request.getfixturevalue(f"{verb}_run")
    (run / f"{verb}.svg").unlink()
    assert faultpath("report", run).status == 0
    assert (run / f"{verb}.svg").exists()
    path = run / f"{verb}.json"
    before = path.read_bytes()
    try:
        edit(path, lambda record: record.update(failed=1))
        faultpath("report", run).refused(f"{verb}.json changed since the run")
    finally:
        path.write_bytes(before)


@pytest.mark.parametrize(
    ("verb", "options"),
    [("map", {"points": 25, "scenes": 2}), ("scan", {"scenes": 59, "fault": "gain:scale=1.4"})],
)
def test_what_is_stopped_goes_on_to_the_same_bytes(
    verb: str, options: dict[str, object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In its first round and in its last."""
    run, whole = tmp_path / "run", tmp_path / "whole"
    assert faultpath(*line(verb, whole, **options)).status == 0
    save, blocks = RunFolder.save_shard, len(shards(whole))
    for count in (2, blocks - 1):

        def stop(folder: RunFolder, *shard: Any, count: int = count) -> None:
            save(folder, *shard)
            if len(shards(folder.path)) >= count:
                raise KeyboardInterrupt

        with monkeypatch.context() as patch:
            patch.setattr(RunFolder, "save_shard", stop)
            ended = faultpath(*line(verb, run, **options))
        assert (ended.status, len(shards(run))) == (INTERRUPTED, count)
        assert "again to resume" in ended.err
        assert not (run / f"{verb}.json").exists()
    assert faultpath(*line(verb, run, **options)).status == 0
    assert len(shards(run)) == blocks
    for name in (f"{verb}.json", "outcomes.parquet", "table.md"):
        assert (run / name).read_bytes() == (whole / name).read_bytes()


def test_without_trials_the_sources_are_ranked_and_nothing_is_written(tmp_path: Path) -> None:
    ended = faultpath(*line("scan", tmp_path / "run", "--no-trials", "--json"))
    assert (ended.status, ended.err) == (0, "")
    first = json.loads(ended.out)["sources"][0]
    assert (first["name"], first["fault"], first["rank"]) == ("gain_estimate", "gain:scale=1.2", 1)
    shown = faultpath(*line("scan", tmp_path / "run", "--no-trials")).out
    assert "1 gain_estimate" in shown
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("verb", "options", "names"),
    [
        ("map", {"spread": "wide"}, ("--spread", "'wide'")),
        ("map", {"mean": "0.1,x"}, ("--mean", "'0.1,x'")),
        ("scan", {"scenes": "many"}, ("--scenes", "'many'")),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    verb: str, options: dict[str, object], names: tuple[str, ...], tmp_path: Path
) -> None:
    faultpath(*line(verb, tmp_path / "run", **options)).refused(*names)
    assert not (tmp_path / "run").exists()
