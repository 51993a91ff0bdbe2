"""Where commands write: nothing but files is replaced, and no path is empty."""

import inspect
import os
import stat
from pathlib import Path
from typing import get_args

import pytest
import typer
from cli_runs import ROOT, TOY, audit, faultpath
from typer.models import OptionInfo

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
