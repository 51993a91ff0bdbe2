"""Comparing finished audits, from Python and from the command line."""

import json
import re
import shutil
from pathlib import Path

import pytest
from cli_runs import faultpath as command
from toy_audits import ROOT

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
    ("given", "said"),
    [
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
    assert shown.count(words(record).headline) == 4
    assert (tmp_path / "page.html").stat().st_size < 3_000_000
    told = json.loads(command("report", *folders, "--json").out)
    assert told["headline"] in shown
    assert told["differs"] == {}
    assert [each["folder"] for each in told["runs"]] == [str(folder) for folder in folders]
    assert told["runs"][0]["record"] == json.loads((toy / "record.json").read_text())
    assert "cannot write" in command("report", *folders, "--out", tmp_path).refused()
