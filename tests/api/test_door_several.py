"""Listing run folders, and comparing finished audits, from Python and from the command line."""

import hashlib
import json
import re
import shutil
import sys
from pathlib import Path

import pytest

import faultpath
from faultpath.api.listing import Listed, runs
from faultpath.core.errors import UserError

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference"
sys.path.append(str(ROOT / "tests" / "cli"))
from cli_runs import faultpath as command  # noqa: E402 - after the path is set


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    return shutil.copytree(REFERENCE / "toy", tmp_path / "runs" / "toy")


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An audit of few scenes, as an interruption leaves it."""
    folder = tmp_path_factory.mktemp("begun") / "run"
    faultpath.audit(
        ROOT / "examples" / "toy.py",
        baseline="calibrated",
        repair="blind",
        fault="gain:scale=0.6",
        library="carts",
        scenes=3,
        workers=0,
        progress=False,
        folder=folder,
    )
    for path in folder.iterdir():
        if path.is_file() and path.name != "manifest.json":
            path.unlink()
    return folder


def reseal(folder: Path, name: str, text: str) -> None:
    """Write a file and its digest, as somebody would who forges a run."""
    (folder / name).write_text(text)
    place = folder / "provenance.json"
    provenance = json.loads(place.read_text())
    provenance["files"][name] = hashlib.sha256(text.encode()).hexdigest()
    place.write_text(json.dumps(provenance))


def only(folder: Path) -> Listed:
    (found,) = runs(folder)
    return found


def test_a_finished_audit_is_told_by_its_record(toy: Path) -> None:
    found, run = only(toy.parent), faultpath.open_run(toy)
    assert (found.folder, found.kind, found.state) == (str(toy), "audit", "finished")
    assert found.words == run.record.verdict.headline
    assert found.trials == run.table().num_rows
    assert found.finished == run.provenance.finished


def test_maps_and_audits_come_latest_first() -> None:
    found = runs(REFERENCE)
    assert [each.finished for each in found] == sorted((e.finished for e in found), reverse=True)
    kinds = {Path(each.folder).name: each.kind for each in found}
    assert (kinds["toy"], kinds["map-toy"]) == ("audit", "map")


def test_an_unfinished_run_counts_its_trials(begun: Path) -> None:
    found = only(begun)
    assert (found.state, found.trials) == ("unfinished", 6 * 3)
    shards = sorted((begun / "shards").iterdir())
    data = shards[0].read_bytes()
    shards[0].write_bytes(data[: len(data) // 2])
    assert only(begun).trials == 5 * 3
    shards[0].write_bytes(data)


def test_damage_is_told(toy: Path) -> None:
    (toy / "record.json").write_text((toy / "record.json").read_text() + " ")
    found = only(toy)
    assert found.state == "damaged"
    assert "record.json changed since the run" in found.words
    (toy / "provenance.json").write_text("{}")
    assert "damaged or from another version" in only(toy).words


def test_a_list_on_the_command_line(toy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It cuts no verdict, and nothing that a record says steers the terminal."""
    record = json.loads((toy / "record.json").read_text())
    headline = "a verdict " * 40 + "that ends\x1b[2J [red]here"
    record["verdict"]["headline"] = headline
    reseal(toy, "record.json", json.dumps(record))
    monkeypatch.chdir(toy.parent.parent)
    shown = command("report").out
    assert "\x1b" not in shown
    assert "that ends\\x1b[2J [red]here" in " ".join(shown.split())
    (told,) = json.loads(command("report", "--json").out)
    assert told["words"] == headline


def test_nothing_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert "runs is no folder" in command("report").refused()
    (tmp_path / "site").mkdir()
    for name in ("manifest.json", "record.json", "map.json"):
        (tmp_path / "site" / name).write_text("{}")
    assert "holds no provenance.json" in command("report", "site").refused()


def test_comparing(toy: Path, tmp_path: Path) -> None:
    dock = faultpath.open_run(REFERENCE / "dock")
    compared = faultpath.compare([toy, dock])
    assert [each.number for each in compared.runs] == [1, 2]
    assert compared.runs[1].record == dock.record
    assert repr(compared) == f"<Comparison: {compared.headline}>"
    page = compared.report(tmp_path / "page.html")
    assert dock.record.question.fault in page.read_text()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([], "two or more"),
        (["toy"], "two or more"),
        ("toy", "two or more"),
        (["toy", "dock", "./toy"], "given twice"),
        (["toy", "map-toy"], "holds no audit"),
        (["toy", "nowhere"], "nowhere holds no provenance.json"),
    ],
    ids=str,
)
def test_what_cannot_be_compared(
    given: list[str] | str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(REFERENCE)
    with pytest.raises(UserError, match=re.escape(said)):
        faultpath.compare(given)


def test_compare_on_the_command_line(toy: Path, tmp_path: Path) -> None:
    copies = [shutil.copytree(toy, tmp_path / name) for name in "abc"]
    folders = [toy, *copies]
    ended = command("report", *folders, "--out", tmp_path / "page.html")
    assert ended.status == 0, ended.err
    shown = " ".join(ended.out.split())
    assert shown.startswith("4 audits side by side 1 ")
    assert "are the same, and so are the outcomes, bit for bit" in shown
    assert "the two are not shown to differ" in shown
    record = faultpath.open_run(toy).record
    assert shown.count(record.verdict.headline) == 4
    assert (tmp_path / "page.html").stat().st_size < 3_000_000
    told = json.loads(command("report", *folders, "--json").out)
    assert told["headline"] in shown
    assert told["differs"] == {}
    assert [each["folder"] for each in told["runs"]] == [str(folder) for folder in folders]
    assert told["runs"][0]["record"] == json.loads((toy / "record.json").read_text())
    assert "two or more" in command("report", toy, "--out", "a.html").refused()
    assert "cannot write" in command("report", *folders, "--out", tmp_path).refused()
