"""A finished run stays what it is under other code that repeats it, and is never overwritten."""

import re
import sys
from datetime import UTC, datetime
from pathlib import Path

import pytest
from stale_toys import Mine

from faultpath.core.errors import UserError
from faultpath.run.execution.provenance import run_provenance
from faultpath.run.execution.runner import run_study
from faultpath.run.work.processes import local


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Mine:
    monkeypatch.setattr(sys, "path", list(sys.path))
    return Mine(tmp_path / "mine")


def _run(mine: Mine, notices: list[str] | None = None, finish: bool = True):
    folder = mine.file.parent.parent / "run"
    said = (notices if notices is not None else []).append
    result = run_study(mine.study(), folder, workers=1, notice=said)
    if finish:
        return run_provenance(folder, [], result, datetime.now(UTC), ["again"], local(1))
    return None


def _contents(mine: Mine) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in (mine.file.parent.parent / "run").rglob("*.*")}


@pytest.mark.parametrize("file", ["file", "helper"])
def test_code_that_repeats_a_finished_run_computes_nothing_and_leaves_it_as_it_is(file, mine):
    first, before = _run(mine), _contents(mine)
    edited: Path = getattr(mine, file)
    edited.write_text(edited.read_text() + "# a word\n")
    notices: list[str] = []
    assert _run(mine, notices) == first
    assert _contents(mine) == before
    shown = rf"before {edited.name} changed\. \d+ of its trials ran again and are equal to the bit"
    assert re.search(shown, notices[0])


@pytest.mark.parametrize(
    ("file", "old", "new", "differs"),
    [
        ("file", "+ push}", "+ push + 1.0}", "distance by up to 1"),
        ("data", "0.0", "0.5", "distance by up to 0.5"),
        (
            "file",
            "def create",
            "def run(*_): raise OSError\n\n\nMine.run = run\n\ndef create",
            "fail",
        ),
    ],
)
def test_code_that_does_not_overwrites_nothing_and_names_a_trial(file, old, new, differs, mine):
    _run(mine)
    before = _contents(mine)
    edited: Path = getattr(mine, file)
    edited.write_text(edited.read_text().replace(old, new))
    with pytest.raises(UserError) as refused:
        _run(mine)
    where = "(correct inputs, seed 0, "
    for part in (f"changed since: {edited.name}", where, "'s0", differs, "choose a new one"):
        assert part in str(refused.value)
    assert _contents(mine) == before


def test_an_unfinished_run_is_not_taken_up_by_other_code(mine):
    _run(mine, finish=False)
    mine.helper.write_text("PUSH = 0.0  # a word\n")
    with pytest.raises(UserError, match="holds trials of other code"):
        _run(mine)
