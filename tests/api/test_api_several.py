"""Several audits: of the sizes of a fault, and finished ones side by side."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from cli_runs import faultpath as command
from toy_audits import AUDIT, ROOT, TOY

import faultpath
from faultpath.core.errors import UserError
from faultpath.report.sentences import words

REFERENCE = ROOT / "docs" / "reference"


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    return shutil.copytree(REFERENCE / "toy", tmp_path / "runs" / "toy")


def test_comparing(toy: Path, tmp_path: Path) -> None:
    dock = faultpath.open_run(REFERENCE / "dock")
    compared = faultpath.compare([toy, dock])
    assert [each.number for each in compared.runs] == [1, 2]
    assert compared.runs[1].record == dock.record
    assert repr(compared) == f"<Comparison: {compared.headline}>"
    page = compared.report(tmp_path / "page.html")
    assert str(dock.record.question.fault) in page.read_text()


@pytest.mark.parametrize(
    ("folders", "sentence"),
    [
        (["toy"], "two or more"),
        ("toy", "two or more"),
        (["toy", 3], "3 is no path: give the folder of a finished run"),
        (["toy", "dock", "./toy"], "given twice"),
        (["toy", "map-toy"], "holds no audit"),
        (["toy", "nowhere"], "nowhere holds no provenance.json"),
    ],
    ids=str,
)
def test_what_cannot_be_compared(
    folders: Any, sentence: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(REFERENCE)
    with pytest.raises(UserError, match=re.escape(sentence)):
        faultpath.compare(folders)


def test_runs_to_compare_come_as_they_may(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REFERENCE)
    assert len(faultpath.compare(Path(name) for name in ("toy", "dock")).runs) == 2
    run, other = map(faultpath.open_run, ("toy", "map-toy"))
    with pytest.raises(UserError, match="two or more"):
        faultpath.compare(run)  # pyright: ignore[reportArgumentType] - a mistake
    with pytest.raises(UserError, match="map-toy holds no audit"):
        faultpath.compare([run, other])


@pytest.mark.parametrize("name", ["toy", "map-toy", "scan-toy"])
def test_pages_go_into_no_folder_of_another_run(name: str, tmp_path: Path) -> None:
    run = faultpath.open_run(REFERENCE / name)
    other = shutil.copytree(REFERENCE / "dock", tmp_path / "dock")
    before = (other / "report.html").read_bytes()
    with pytest.raises(UserError, match="dock holds another run"):
        run.report(other)
    with pytest.raises(UserError, match="an empty path names nothing"):
        run.report("")
    assert (other / "report.html").read_bytes() == before


@pytest.mark.usefixtures("elsewhere")
@pytest.mark.parametrize("folder", ["", 3])
def test_sizes_go_into_no_folder_that_is_none(folder: object, tmp_path: Path) -> None:
    sizes = QUESTION | {"fault": "gain:scale=0.6,0.8", "folder": folder}
    with pytest.raises(UserError, match=r"^folder: "):
        faultpath.api.audits(TOY, **sizes)
    assert not list(tmp_path.iterdir())


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
    assert shown.count(words(record).headline) == 4
    assert (tmp_path / "page.html").stat().st_size < 3_000_000
    printed = json.loads(command("report", *folders, "--json").out)
    assert printed["headline"] in shown
    assert printed["differs"] == {}
    assert [each["folder"] for each in printed["runs"]] == [str(folder) for folder in folders]
    assert printed["runs"][0]["record"] == json.loads((toy / "record.json").read_text())
    assert "cannot write" in command("report", *folders, "--out", tmp_path).refused()


QUESTION = AUDIT | {"scenes": 4, "signals": False}


@pytest.mark.usefixtures("without_pages")
def test_each_size_is_an_audit_as_if_alone(tmp_path: Path) -> None:
    sizes = QUESTION | {"fault": "gain:scale=0.6,0.8"}
    _, strong = faultpath.api.audits(TOY, **sizes, folder=tmp_path)
    alone = faultpath.audit(TOY, **QUESTION | {"fault": "gain:scale=0.8"}, folder=tmp_path / "a")
    assert strong.record == alone.record
    assert strong.table() == alone.table()
    with pytest.raises(UserError, match="a holds a run: give another folder"):
        faultpath.api.audits(TOY, **sizes, folder=alone.folder)
    with pytest.raises(UserError, match=r"takes one; from Python, faultpath\.api\.audits"):
        faultpath.audit(TOY, **sizes)
