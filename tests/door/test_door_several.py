"""Listing run folders, and comparing finished audits, from Python and from the command line."""

import hashlib
import json
import os
import re
import shutil
import sys
from pathlib import Path

import pytest

import faultpath
from faultpath.door.listing import Listed, runs
from faultpath.errors import UserError
from faultpath.record import Ledger, Reproduction

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


def only(folder: Path) -> Listed:
    (found,) = runs([folder])
    return found


def reseal(folder: Path, name: str, text: str) -> None:
    """Write a file and its digest, as somebody would who forges a run."""
    (folder / name).write_text(text)
    place = folder / "provenance.json"
    provenance = json.loads(place.read_text())
    provenance["files"][name] = hashlib.sha256(text.encode()).hexdigest()
    place.write_text(json.dumps(provenance))


def test_a_finished_audit_is_told_by_its_record(toy: Path) -> None:
    found, run = only(toy.parent), faultpath.open_run(toy)
    assert (found.folder, found.kind, found.state) == (str(toy), "audit", "finished")
    assert found.words == run.record.verdict.headline
    assert found.trials == run.table().num_rows
    assert found.scenes == run.record.scenes
    assert run.provenance.system_fingerprint == found.fingerprint
    assert found.wall_s == run.provenance.wall_s
    assert found.date.isoformat(timespec="seconds") == run.provenance.finished


def test_maps_and_audits_latest_first_and_once() -> None:
    found = runs([REFERENCE, REFERENCE / "toy"])
    assert [each.date for each in found] == sorted((e.date for e in found), reverse=True)
    assert len({each.folder for each in found}) == len(found)
    kinds = {Path(each.folder).name: each.kind for each in found}
    assert (kinds["toy"], kinds["map-toy"], kinds["drift-L3"]) == ("audit", "map", "run")
    assert {each.state for each in found} == {"finished"}


def test_how_far_an_unfinished_run_has_come(begun: Path) -> None:
    found = only(begun)
    kept = found.trials
    assert (found.kind, found.state, found.scenes) == ("audit", "unfinished", 3)
    assert kept == 6 * 3, "six arms are distinct"
    asked = f"the run asks for {kept}, which stand for {8 * 3}"
    assert found.words == f"{kept} trials kept; {asked}"
    shards = sorted((begun / "shards").iterdir())
    data = shards[0].read_bytes()
    shards[0].write_bytes(data[: len(data) // 2])
    assert only(begun).words == f"{kept - 3} trials kept; {asked}"
    shards[0].write_bytes(data)


def test_damage_is_told_in_a_few_words(toy: Path, begun: Path) -> None:
    assert only(toy).state == "finished"
    (toy / "record.json").write_text((toy / "record.json").read_text() + " ")
    found = only(toy)
    assert (found.kind, found.state) == ("audit", "damaged")
    assert found.words == "record.json changed since the run, by the SHA-256 in provenance.json"
    (toy / "traces.parquet").unlink()
    assert only(toy).words == "holds no traces.parquet"
    (toy / "provenance.json").write_text("{}")
    assert "damaged or from another version" in only(toy).words
    (toy / "provenance.json").unlink()
    os.mkfifo(toy / "provenance.json")
    assert only(toy).state == "damaged"
    copy = shutil.copytree(begun, toy.parent / "begun")
    (copy / "manifest.json").write_text("[" * 100_000)
    assert only(copy).words.startswith("manifest.json cannot be read as a manifest")


def test_what_is_no_run_is_not_listed(tmp_path: Path) -> None:
    (tmp_path / "site").mkdir()
    for name in ("manifest.json", "record.json", "map.json"):
        (tmp_path / "site" / name).write_text("{}")
    assert runs([tmp_path]) == ()
    with pytest.raises(UserError, match="is no folder"):
        runs([tmp_path / "nowhere"])


def test_a_reproduction_and_a_probe(tmp_path: Path, toy: Path, begun: Path) -> None:
    place = tmp_path / "paper"
    leg = place / "flights" / "L3"
    shutil.copytree(begun, leg)
    found = only(place)
    assert (found.kind, found.state) == ("reproduction", "unfinished")
    assert found.words == "18 trials kept, of 1 settings so far"
    ledger = Ledger(library="held-out", library_hash="x", scenes=7, seeds=(0,), claims=())
    made = Reproduction(
        profile="quick",
        ledger=ledger,
        tables=(),
        figures=(),
        gallery=(),
        configurations=(),
        trials=800,
        failed_trials=0,
        flown=None,
    )
    for name in ("provenance.json", "outcomes.parquet"):
        shutil.copy(toy / name, place / name)
    provenance = json.loads((place / "provenance.json").read_text())
    digests = {"outcomes.parquet": provenance["files"]["outcomes.parquet"]}
    (place / "provenance.json").write_text(json.dumps(provenance | {"files": digests}))
    reseal(place, "reproduction.json", made.model_dump_json())
    found = only(place)
    assert (found.kind, found.state, found.scenes) == ("reproduction", "finished", 7)
    assert "tests the pipeline" in found.words
    probe = tmp_path / "probe"
    probe.mkdir()
    (probe / "a.measured.parquet").write_bytes(b"")
    assert only(probe).words == "1 measurements kept"
    (probe / "probe.json").write_text("{}")
    assert (only(probe).kind, only(probe).state) == ("probe", "damaged")


def test_the_verdict_is_never_cut_and_steers_no_terminal(toy: Path) -> None:
    record = json.loads((toy / "record.json").read_text())
    headline = "a verdict " * 40 + "that ends\x1b[2J [red]here"
    record["verdict"]["headline"] = headline
    reseal(toy, "record.json", json.dumps(record))
    shown = command("runs", toy).out
    assert "\x1b" not in shown
    assert " ".join(shown.split()).endswith("that ends\\x1b[2J [red]here")
    assert all(len(line) <= 80 for line in shown.splitlines()[1:])
    (told,) = json.loads(command("runs", toy, "--json").out)
    assert told["words"] == headline


def test_nothing_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert command("runs").out == "There are no runs below runs.\n"
    assert command("runs", "--json").out == "[]\n"
    assert "nowhere is no folder" in command("runs", "nowhere").refused()


def test_comparing(toy: Path, tmp_path: Path) -> None:
    dock = faultpath.open_run(REFERENCE / "dock")
    compared = faultpath.compare([toy, dock])
    assert [each.number for each in compared.runs] == [1, 2]
    assert compared.runs[1].record == dock.record
    assert repr(compared) == f"<Comparison: {compared.headline}>"
    page = compared.report(tmp_path / "page.html")
    assert dock.record.question.fault in page.read_text()
    assert dock.record.question.fault in compared._repr_markdown_()


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
    ended = command("compare", *folders, "--out", tmp_path / "page.html")
    assert ended.status == 0, ended.err
    shown = " ".join(ended.out.split())
    assert shown.startswith("4 audits side by side 1 ")
    assert "are the same, and so are the outcomes, bit for bit" in shown
    assert "the two are not shown to differ" in shown
    record = faultpath.open_run(toy).record
    assert shown.count(record.verdict.headline) == 4
    assert (tmp_path / "page.html").stat().st_size < 3_000_000
    told = json.loads(command("compare", *folders, "--json").out)
    assert told["headline"] in shown
    assert told["differs"] == {}
    assert [each["folder"] for each in told["runs"]] == [str(folder) for folder in folders]
    assert told["runs"][0]["record"] == json.loads((toy / "record.json").read_text())
    assert "two or more" in command("compare", toy).refused()
    assert "cannot write" in command("compare", *folders, "--out", tmp_path).refused()
