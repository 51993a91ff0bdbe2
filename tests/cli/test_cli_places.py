"""Where commands write: nothing but files is replaced, and no path is empty."""

import inspect
import os
import shutil
from pathlib import Path
from typing import get_args

import pytest
import typer
from cli_runs import ROOT, TOY, audit, faultpath
from typer.models import OptionInfo

from faultpath import UserError, open_run
from faultpath.cli.app import build
from faultpath.cli.options import path


def _paths(verbs: typer.Typer, before: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    options: list[tuple[str, ...]] = []
    for group in verbs.registered_groups:
        options += _paths(group.typer_instance, (*before, group.name))
    for verb in verbs.registered_commands:
        for name, parameter in inspect.signature(verb.callback).parameters.items():
            kind, *how = get_args(parameter.annotation) or (parameter.annotation,)
            if Path in (kind, *get_args(kind)):
                assert how[0].parser is path, f"{verb.name}: {name} needs parser=path"
                named = how[0].default if isinstance(how[0].default, str) else f"--{name}"
                option = named if isinstance(how[0], OptionInfo) else name
                options.append((*before, verb.name, option))
    return options


@pytest.mark.parametrize("option", _paths(build()), ids=" ".join)
def test_a_path_that_names_nothing_is_refused(option: tuple[str, ...], tmp_path: Path):
    *verbs, option = option
    place = [option, ""] if option.startswith("-") else [""]
    assert option.strip("-").upper() in faultpath(*verbs, *place).refused("path").upper()
    assert list(tmp_path.iterdir()) == []


REFERENCE = ROOT / "docs" / "reference"
L3 = REFERENCE / "quadrotor-L3"
VERSIONS = ["--baseline", "calibrated", "--repair", "blind", "--library", "carts", "--scenes", "2"]
FAULT = ["--fault", "gain:scale=0.6"]
COMMANDS = {
    "audit": ["audit", TOY, *VERSIONS, *FAULT, "--workers", 0],
    "map": f"map {TOY} --fault gain --against controller,observer --up-to 0.4 --points 25".split(),
    "reproduce": ["reproduce", "table-1", "--workers", 0],
    "train": ["train", "quadrotor", "wm-a"],
    "judge": ["judge", "all.csv", "--baseline", "old", "--repair", "new"],
}
COMMANDS["map"] += [*VERSIONS, "--workers", 0]
COMMANDS["scan"] = f"scan {TOY} --variant calibrated --fault gain:scale=1.2 --workers 0".split()
OUTPUTS = {
    "report --out": ["report", REFERENCE / "toy", REFERENCE / "dock", "--out"],
    "audit --junit": [*COMMANDS["audit"], "--junit"],
    "audit --summary": [*COMMANDS["audit"], "--summary"],
}
"""Every option that takes the name of a file to write, and a command that ends with it."""


@pytest.mark.parametrize("option", ["report --out", "audit --junit"])
def test_what_the_same_verb_wrote_is_replaced(option: str, tmp_path: Path) -> None:
    (place := tmp_path / "mine.html").touch()
    for _ in range(2):
        ended = faultpath(*OUTPUTS[option], place)
        assert ended.status == 0, ended.err
        assert place.stat().st_size > 100


@pytest.mark.parametrize("command", ["audit", "map", "scan", "reproduce", "train"])
def test_a_run_goes_into_a_folder_and_a_page_into_a_file(command: str, tmp_path: Path) -> None:
    os.mkfifo(place := tmp_path / "place")
    faultpath(*COMMANDS[command], "--out", place).refused(str(place))
    faultpath(*OUTPUTS["report --out"], place).refused("it is a pipe")
    assert place.is_fifo()
    assert os.listdir(tmp_path) == ["place"]


def test_pages_do_not_follow_a_link_out_of_the_run_folder(tmp_path: Path):
    assert audit(out="run", scenes=2).status == 0
    (mine := tmp_path / "mine").write_text("mine")
    for name in ("report.html", "outcomes.parquet"):
        (place := tmp_path / "run" / name).unlink()
        place.symlink_to(mine)
        audit(out="run", scenes=2).refused("run", "link out of")
        assert mine.read_text() == "mine"
        place.unlink()


@pytest.mark.parametrize(
    ("command", "name", "text"),
    [
        ("audit", "report.html", "<html>mine"),
        ("map", "map.svg", "mine"),
        ("scan", "scan.svg", "mine"),
        ("judge", "record.json", "{}"),
        ("judge", "notes.txt", "mine"),
        ("audit", "notes.txt", "mine"),
    ],
)
def test_a_run_does_not_begin_among_files_of_somebody_else(
    command: str, name: str, text: str, tmp_path: Path
) -> None:
    (place := tmp_path / "place").mkdir()
    (place / name).write_text(text)
    results()
    faultpath(*COMMANDS[command], "--out", place).refused(f"place holds {name}")
    assert (place / name).read_text() == text
    assert os.listdir(place) == [name]


def results() -> None:
    Path("all.csv").write_text("variant,scene,success\nold,s,0\nnew,s,1\n")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(shutil.copytree(REFERENCE / "toy", tmp_path_factory.mktemp("run") / "run"))


@pytest.mark.parametrize("option", OUTPUTS)
def test_no_file_of_a_run_or_of_somebody_else_is_replaced(
    option: str, run: Path, tmp_path: Path
) -> None:
    (mine := tmp_path / "mine").write_text("<html><!-- about faultpath -->")
    page = run / "report.html"
    before = page.read_bytes()
    faultpath(*OUTPUTS[option], mine).refused("mine is there already")
    for name in ("report.html", "new.md"):
        faultpath(*OUTPUTS[option], run / name).refused(f"{name} lies in the folder of a run")
    assert not (run / "new.md").exists()
    assert mine.read_text() == "<html><!-- about faultpath -->"
    assert page.read_bytes() == before


def test_a_file_is_written_for_one_option(tmp_path: Path) -> None:
    results()
    both = ["--junit", "page.md", "--summary", tmp_path / "page.md"]
    faultpath(*COMMANDS["judge"], *both).refused("--junit and --summary both name page.md")
    assert os.listdir(tmp_path) == ["all.csv"]


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_is_no_folder_for_a_run(command: str, tmp_path: Path) -> None:
    results()
    (place := tmp_path / "afile").write_text("mine")
    for out in (place, place / "below"):
        faultpath(*COMMANDS[command], "--out", out).refused("afile is a file: name a folder")
    assert place.read_text() == "mine"


@pytest.fixture(scope="module")
def runs(finished: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A finished run of each command."""
    place = tmp_path_factory.mktemp("runs")
    for command in ("map", "scan"):
        assert faultpath(*COMMANDS[command], "--out", place / command).status == 0
    return {"audit": finished, "map": place / "map", "scan": place / "scan"}


QUESTIONS = COMMANDS | {
    "scan of another error": [*COMMANDS["scan"], "--fault", "velocity:offset=0.1"],
    "map of another fault": ["velocity" if a == "gain" else a for a in COMMANDS["map"]],
    "map with another seed": [*COMMANDS["map"], "--seeds", "1"],
    "scan with another seed": [*COMMANDS["scan"], "--seeds", "1"],
}


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("audit", "map"),
        ("map", "audit"),
        ("scan", "scan of another error"),
        ("map", "map of another fault"),
        ("map", "map with another seed"),
        ("scan", "scan with another seed"),
    ],
)
def test_a_run_does_not_go_on_in_one_of_another_question(
    first: str, second: str, runs: dict[str, Path]
) -> None:
    """The variants of a map may be others from round to round, but a map is no audit."""
    before = {path: path.read_bytes() for path in runs[first].iterdir() if path.is_file()}
    faultpath(*QUESTIONS[second], "--out", runs[first]).refused(
        "holds another run, with another question"
    )
    assert all(path.read_bytes() == data for path, data in before.items())


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


def test_a_judgement_that_was_killed_goes_on() -> None:
    results()
    line = [*COMMANDS["judge"], "--out", "run"]
    assert faultpath(*line).status == 0
    Path("run/provenance.json").unlink()
    assert faultpath(*line).status == 0
    audit(out="run", scenes=2).refused("not of this run")


def test_a_run_folder_is_no_loop_and_its_lock_no_link(tmp_path: Path):
    """Taking the lock empties the file: through a link that would be somebody else's."""
    (tmp_path / "loop").symlink_to("loop")
    faultpath("report", "loop").refused("loop")  # what else it says depends on the Python
    (mine := tmp_path / "mine").write_text("mine")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / ".lock").symlink_to(mine)
    audit(out="run", scenes=2).refused("run")
    assert mine.read_text() == "mine"
