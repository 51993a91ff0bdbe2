"""Trials of one state of a user's code are never taken for those of another."""

import re
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import pytest
from stale_toys import Mine

from faultpath.core.errors import UserError
from faultpath.run.code import source_state, system_code
from faultpath.run.execution.recheck import Rechecks
from faultpath.run.execution.runner import run_plan
from faultpath.run.plan import Task, Unit
from faultpath.run.provenance import RunProvenance, run_provenance
from faultpath.run.registry import load_system
from faultpath.run.work.processes import local

pytestmark = pytest.mark.slow  # all together

PLACES = ("file", "helper", "data")


@pytest.fixture
def mine(tmp_path: Path) -> Mine:
    return Mine(tmp_path / "mine")


def _edit(mine: Mine, place: str) -> str:
    """Let every trial end one metre further off, by one file; return the name of that file."""
    path: Path = getattr(mine, place)
    old, new = {
        "file": ("+ push}", "+ push + 1.0}"),
        "helper": ("0.0", "1.0"),
        "data": ("0.0", "1.0"),
    }[place]
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    return path.name


def _distances(result) -> list[float]:
    return [row.outcome.metrics["distance"] for row in result.trials]


def test_after_an_edit_nothing_stale_comes_back(mine, tmp_path):
    folder = tmp_path / "run"
    before = run_plan(mine.plan(), folder, workers=1)
    for place in PLACES:
        kept = {p: p.read_bytes() for p in folder.rglob("*.parquet")}
        edited = _edit(mine, place)
        with pytest.raises(UserError, match=rf"other code than this.*{edited}"):
            run_plan(mine.plan(), folder, workers=1)
        assert {p: p.read_bytes() for p in folder.rglob("*.parquet")} == kept
        folder = tmp_path / place
        after = run_plan(mine.plan(), folder, workers=1)
        assert after.blocks_kept == 0
        assert after.system_fingerprint != before.system_fingerprint
        assert _distances(after) == pytest.approx([x + 1.0 for x in _distances(before)])
        before = after


def test_an_edit_while_the_system_builds_is_not_what_was_loaded(mine):
    spec = mine.plan().system
    before = source_state(spec)
    system = load_system(spec)
    _edit(mine, "file")
    assert "my.py" not in before.changed(system_code(system, spec).state)


def test_edited_back_the_trials_are_kept(mine, tmp_path):
    run_plan(mine.plan(), tmp_path / "run", workers=1)
    source = mine.helper.read_text()
    _edit(mine, "helper")
    mine.helper.write_text(source)
    notices: list[str] = []
    again = run_plan(mine.plan(), tmp_path / "run", workers=1, notice=notices.append)
    assert (again.blocks_kept, again.blocks_computed) == (3, 0)
    assert [notice.partition(", ")[0] for notice in notices] == ["Kept 10 of 10 trials"]


@pytest.mark.parametrize("place", PLACES)
def test_an_edit_while_a_run_is_under_way_ends_it(place, mine, tmp_path):
    """A worker that is built after the edit, or that reads the file after it, is refused."""
    once, log = tmp_path / "died", tmp_path / "log"
    plan = mine.plan(dies="s05", once=str(once), log=str(log))
    edited = ""

    def edit(progress) -> None:
        nonlocal edited
        if not edited and once.exists():
            edited = _edit(mine, place)

    with pytest.raises(UserError, match="changed while the run was under way") as refusal:
        run_plan(plan, tmp_path / "run", workers=1, progress=edit)
    assert edited in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_without_workers_data_that_change_under_way_end_the_run(mine, tmp_path):
    def edit(progress) -> None:
        if progress.done == 8:
            mine.data.write_text("1.0")

    with pytest.raises(UserError, match=r"push\.txt changed while the run was under way"):
        run_plan(mine.plan(), tmp_path / "run", workers=0, progress=edit)
    assert len(list((tmp_path / "run" / "shards").iterdir())) == 2


def test_an_edit_during_second_runs_is_no_finding_of_theirs(mine, tmp_path, monkeypatch):
    def edit(rechecks: Rechecks, sound: list[Unit]) -> tuple[Task, ...]:
        mine.data.write_text("1.0")
        return tasks(rechecks, sound)

    tasks = Rechecks.tasks
    with monkeypatch.context() as patch:
        patch.setattr(Rechecks, "tasks", edit)
        with pytest.raises(UserError, match=r"push\.txt changed while the run was under way"):
            run_plan(mine.plan(), tmp_path / "run", workers=0)
    mine.data.write_text("0.0")
    assert run_plan(mine.plan(), tmp_path / "run", workers=0).findings == ()


def test_an_edit_under_way_of_what_nothing_loads_ends_no_run(mine, tmp_path):
    other = mine.file.with_name("plots.py")
    other.touch()
    run_plan(mine.plan(), tmp_path / "run", workers=0, progress=lambda _: other.write_text("x"))
    with pytest.raises(UserError, match=r"other code than this.*plots\.py"):
        run_plan(mine.plan(), tmp_path / "run", workers=0)


def test_data_that_are_not_there_are_named(mine, tmp_path):
    mine.data.unlink()
    with pytest.raises(UserError, match=r"push\.txt.*data_files"):
        run_plan(mine.plan(), tmp_path / "run", workers=0)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Iterator[tuple[Mine, RunProvenance]]:
    """A system with a finished run beside it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "path", list(sys.path))
        mine = Mine(tmp_path_factory.mktemp("finished") / "mine")
        yield mine, _finished(mine)


@pytest.fixture
def finished(whole) -> Iterator[tuple[Mine, RunProvenance]]:
    """The same, whose files are put back after the test, and whose run has to be as it was."""
    mine, _ = whole
    sources, before = ({p: p.read_bytes() for p in _files(mine, name)} for name in ("mine", "run"))
    yield whole
    assert {p: p.read_bytes() for p in _files(mine, "run")} == before
    for path, data in sources.items():
        path.write_bytes(data)


def _files(mine: Mine, folder: str) -> list[Path]:
    return [p for p in (mine.file.parents[1] / folder).rglob("*.*") if p.is_file()]


def _finished(mine: Mine, notices: list[str] | None = None) -> RunProvenance:
    folder = mine.file.parents[1] / "run"
    said = (notices if notices is not None else []).append
    result = run_plan(mine.plan(), folder, workers=1, notice=said)
    return run_provenance(folder, [], result, datetime.now(UTC), ["again"], local(1))


@pytest.mark.parametrize("file", ["file", "helper"])
def test_code_that_repeats_a_finished_run_computes_nothing_and_leaves_it_as_it_is(file, finished):
    mine, first = finished
    edited: Path = getattr(mine, file)
    edited.write_text(edited.read_text() + "# a word\n")
    notices: list[str] = []
    assert _finished(mine, notices) == first
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
def test_code_that_does_not_overwrites_nothing_and_names_a_trial(file, old, new, differs, finished):
    mine, _ = finished
    edited: Path = getattr(mine, file)
    edited.write_text(edited.read_text().replace(old, new))
    with pytest.raises(UserError) as refused:
        _finished(mine)
    where = "(correct inputs, seed 0, "
    for part in (f"changed since: {edited.name}", where, "'s0", differs, "choose a new one"):
        assert part in str(refused.value)


def test_a_finished_run_that_stopped_early_counts_too_and_takes_no_trial_of_other_code(
    mine, tmp_path
):
    def run(scenes: int) -> str:
        result = run_plan(
            mine.plan().model_copy(update={"scenes_per_analysis": 2}),
            tmp_path / "run",
            workers=1,
            stop=lambda trials: len({trial.outcome.scene for trial in trials}) >= scenes,
        )
        run_provenance(tmp_path / "run", [], result, datetime.now(UTC), ["again"], local(1))
        return result.outcomes_sha256

    first = run(4)
    mine.file.write_text(mine.file.read_text() + "# a word\n")
    assert run(4) == first
    with pytest.raises(UserError, match=r"other code than this.*my\.py"):
        run(8)
