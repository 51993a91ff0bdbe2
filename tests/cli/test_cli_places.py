"""Where commands write: nothing but files is replaced, and no path is empty."""

import inspect
import os
import shutil
import stat
from pathlib import Path
from typing import get_args

import pytest
import typer
from cli_runs import ROOT, TOY, audit, faultpath
from typer.models import OptionInfo

from faultpath import UserError, open_run
from faultpath.cli.app import build
from faultpath.cli.options import path


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _paths(verbs: typer.Typer, before: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Return verbs and name of every option and argument that is annotated as a path."""
    found: list[tuple[str, ...]] = []
    for group in verbs.registered_groups:
        found += _paths(group.typer_instance, (*before, group.name))
    for verb in verbs.registered_commands:
        for name, parameter in inspect.signature(verb.callback).parameters.items():
            kind, *how = get_args(parameter.annotation) or (parameter.annotation,)
            if Path in (kind, *get_args(kind)):
                assert how[0].parser is path, f"{verb.name}: {name} needs parser=path"
                named = how[0].default if isinstance(how[0].default, str) else f"--{name}"
                option = named if isinstance(how[0], OptionInfo) else name
                found.append((*before, verb.name, option))
    return found


@pytest.mark.parametrize("option", _paths(build()), ids=" ".join)
def test_a_path_that_names_nothing_is_refused(option: tuple[str, ...], tmp_path: Path):
    *verbs, option = option
    place = [option, ""] if option.startswith("-") else [""]
    sentence = faultpath(*verbs, *place).refused()
    assert option.strip("-").upper() in sentence.upper()
    assert "path" in sentence
    assert list(tmp_path.iterdir()) == []


def test_an_empty_out_is_refused_with_everything_else_given(tmp_path: Path):
    assert "--out" in audit(out="").refused()
    assert list(tmp_path.iterdir()) == []


def _device(place: Path) -> None:
    try:
        os.mknod(place, 0o600 | stat.S_IFCHR, os.makedev(1, 3))
    except PermissionError:
        pytest.skip("only root makes devices")


THINGS = {"a device": _device, "a pipe": os.mkfifo, "a folder": Path.mkdir}


@pytest.mark.parametrize("what", THINGS)
def test_a_page_replaces_nothing_but_a_file(what: str, tmp_path: Path):
    place = tmp_path / "place"
    THINGS[what](place)
    before = place.lstat().st_mode
    assert f"it is {what}" in faultpath(*OUTPUTS["report --out"], place).refused()
    assert place.lstat().st_mode == before
    assert os.listdir(tmp_path) == ["place"]


REFERENCE = ROOT / "docs" / "reference"
OUTPUTS = {
    "report --out": ["report", REFERENCE / "toy", REFERENCE / "dock", "--out"],
    "plan --out": ["plan", TOY, "--baseline=calibrated", "--repair=blind", "--out"],
}
"""Every option that takes the name of a file to write, and a command that ends with it."""


def test_what_faultpath_wrote_is_replaced(tmp_path: Path):
    place = tmp_path / "mine.html"
    place.touch()
    for _ in range(2):
        ended = faultpath(*OUTPUTS["report --out"], place)
        assert (ended.status, ended.err) == (0, "")
        assert place.stat().st_size > 100


def test_a_page_goes_where_a_link_leads(tmp_path: Path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "link").symlink_to("deep/page.html")
    ended = faultpath(*OUTPUTS["report --out"], "link")
    assert (ended.status, ended.err) == (0, "")
    assert (tmp_path / "link").is_symlink()
    assert "<html" in (tmp_path / "deep" / "page.html").read_text()


AUDIT = "--baseline calibrated --repair blind --fault gain:scale=0.6 --library carts --scenes 2"
MAP = AUDIT.replace(":scale=0.6", " --against controller,observer --up-to 0.4")
COMMANDS = {
    "audit": ["audit", TOY, *AUDIT.split(), "--workers", 0],
    "map": ["map", TOY, *MAP.split(), "--workers", 0],
    "reproduce": ["reproduce", "table-1", "--workers", 0],
    "train": ["train", "quadrotor", "wm-a"],
}


@pytest.mark.parametrize("what", ["a device", "a pipe", "a file"])
@pytest.mark.parametrize("command", COMMANDS)
def test_a_run_goes_into_a_folder_and_replaces_nothing_else(
    command: str, what: str, tmp_path: Path
):
    place = tmp_path / "place"
    THINGS.get(what, Path.touch)(place)
    before = place.lstat().st_mode
    assert str(place) in faultpath(*COMMANDS[command], "--out", place).refused()
    assert place.lstat().st_mode == before


def test_pages_do_not_follow_a_link_out_of_the_run_folder(tmp_path: Path):
    assert audit(out="run", scenes=2).status == 0
    mine = tmp_path / "mine"
    mine.write_text("mine")
    for name in ("report.html", "record.json", "outcomes.parquet"):
        (tmp_path / "run" / name).unlink()
        (tmp_path / "run" / name).symlink_to(mine)
        sentence = audit(out="run", scenes=2).refused()
        assert name in sentence or "run" in sentence
        assert "link out of" in sentence
        assert mine.read_text() == "mine"
        (tmp_path / "run" / name).unlink()


MINE = {"report.html": "<html>mine", "table.md": "mine", "record.json": "{}", "map.svg": "mine"}


@pytest.mark.parametrize("name", MINE)
@pytest.mark.parametrize("command", ["audit", "map", "judge"])
def test_a_run_does_not_begin_among_files_of_somebody_else(
    command: str, name: str, tmp_path: Path
) -> None:
    place = tmp_path / "place"
    place.mkdir()
    (place / name).write_text(MINE[name])
    (tmp_path / "all.csv").write_text("arm,scene,success\nold,s,0\nnew,s,1\n")
    judge = ["judge", "all.csv", "--baseline", "old", "--repair", "new"]
    said = faultpath(*COMMANDS.get(command, judge), "--out", place).refused()
    assert f"place holds {name}, which is not of this run" in said
    assert (place / name).read_text() == MINE[name]
    assert [each.name for each in place.iterdir()] == [name]
    assert "which is not of this run" in faultpath(*judge, "--out", place).refused()


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(shutil.copytree(REFERENCE / "toy", tmp_path_factory.mktemp("run") / "run"))


L3 = REFERENCE / "quadrotor-L3"
TO_FILES = {
    "report --out": OUTPUTS["report --out"],
    "report --dependent-failures": ["report", L3, f"{L3}-20", "--dependent-failures"],
    "report --dependent-failures of one": ["report", L3, "--dependent-failures"],
    "plan --out": [*OUTPUTS["plan --out"][:-1], "--fault=gain:scale=0.6", "--out"],
    "plan --dependent-failures": [*OUTPUTS["plan --out"][:-1], "--dependent-failures"],
    "audit --junit": [*COMMANDS["audit"], "--junit"],
    "audit --summary": [*COMMANDS["audit"], "--summary"],
}


@pytest.mark.parametrize("option", TO_FILES)
def test_no_file_of_a_run_is_replaced_by_what_is_no_part_of_it(option: str, run: Path) -> None:
    for name in ("record.json", "report.html", "table.md"):
        before = (run / name).read_bytes()
        said = faultpath(*TO_FILES[option], run / name).refused()
        assert f"{name} belongs to the run in that folder" in said
        assert (run / name).read_bytes() == before


@pytest.mark.parametrize("option", sorted({*TO_FILES} - {"audit --summary"}))
def test_a_file_of_somebody_else_is_not_replaced(option: str, tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("<html><!-- about faultpath -->")
    said = faultpath(*TO_FILES[option], tmp_path / "mine").refused()
    assert "mine is there already, and not a file that this may replace" in said
    assert (tmp_path / "mine").read_text() == "<html><!-- about faultpath -->"


@pytest.mark.parametrize("option", ["report --dependent-failures", "audit --junit"])
def test_what_the_same_verb_wrote_is_replaced(option: str, tmp_path: Path) -> None:
    for _ in range(2):
        ended = faultpath(*TO_FILES[option], tmp_path / "mine")
        assert ended.status == 0, ended.err


@pytest.mark.parametrize("first", ["audit", "map"])
def test_a_run_does_not_go_on_in_one_of_another_kind(first: str, tmp_path: Path) -> None:
    """The arms of a map may be others from round to round, but a map is no audit."""
    assert faultpath(*COMMANDS[first], "--out", "run").status == 0
    before = {each: each.read_bytes() for each in Path("run").iterdir() if each.is_file()}
    other = COMMANDS["map" if first == "audit" else "audit"]
    assert "holds the run of another study" in faultpath(*other, "--out", "run").refused()
    assert all(each.read_bytes() == data for each, data in before.items())


def test_pages_replace_no_page_of_somebody_else(run: Path, tmp_path: Path) -> None:
    opened = open_run(run)
    (tmp_path / "table.md").write_text("mine")
    with pytest.raises(UserError, match=r"holds table.md, which is not of this run"):
        opened.report(tmp_path)
    for _ in range(2):  # what it wrote itself may be written again
        assert len(opened.report(tmp_path / "other")) > 1
    (tmp_path / "other" / "report.html").write_text("mine")
    with pytest.raises(UserError, match=r"report.html is there already, and not a file"):
        opened.report(tmp_path / "other")
    assert (tmp_path / "other" / "report.html").read_text() == "mine"


def test_a_judgement_that_was_killed_goes_on(tmp_path: Path) -> None:
    (tmp_path / "all.csv").write_text("arm,scene,success\nold,s,0\nnew,s,1\n")
    line = ["judge", "all.csv", "--baseline", "old", "--repair", "new", "--out", "run"]
    assert faultpath(*line).status == 0
    (tmp_path / "run" / "provenance.json").unlink()
    assert faultpath(*line).status == 0
    assert "which is not of this run" in audit(out="run", scenes=2).refused()


def test_the_lock_of_a_run_folder_is_no_link(tmp_path: Path):
    """Taking the lock empties the file: through a link that would be somebody else's."""
    mine = tmp_path / "mine"
    mine.write_text("mine")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / ".lock").symlink_to(mine)
    assert "run" in audit(out="run", scenes=2).refused()
    assert mine.read_text() == "mine"


def test_a_path_is_taken_as_it_stands():
    assert path("~/a b") == Path("~/a b")
    assert path(Path("runs")) == Path("runs")
