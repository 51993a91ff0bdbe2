"""What `faultpath --help` shows: verbs in groups, one example of each that can be typed."""

import re
import shlex
import subprocess
import sys

import pytest
import typer
from cli_runs import faultpath

import faultpath as package
from faultpath.cli.app import build, panels

VERBS = {entry.name: entry for entries in panels().values() for entry in entries}


def test_every_verb_stands_in_a_group_with_an_example() -> None:
    command = typer.main.get_command(build())
    assert set(VERBS) == set(command.commands)
    shown = faultpath("--help").out
    assert all(f"│ {verb} " in shown for verb in VERBS)
    assert shown.index("Begin here") < shown.index("│ report") < shown.index("More")


def test_what_few_ask_for_stands_below_what_everybody_does() -> None:
    ordinary, advanced = faultpath("audit", "--help").out.split("Advanced")
    assert len(re.findall(r"^│ [* ] *--", ordinary, flags=re.MULTILINE)) <= 14
    assert "--baseline" in ordinary
    assert "--fail-if" in advanced


@pytest.mark.parametrize("verb", VERBS)
def test_an_example_can_be_typed(verb: str) -> None:
    line = [verb, *shlex.split(VERBS[verb].example)]
    command = typer.main.get_command(build(line))
    while line and line[0] in getattr(command, "commands", ()):
        command = command.commands[line.pop(0)]
    context = command.context_class(command)
    _, left, _ = command.make_parser(context).parse_args(line)
    assert not left  # an option that does not exist raises


WRITTEN = """
from typing import Annotated, Literal
def create(
    part: Annotated[str, "A part, file.py:factory: or [bold]x[/bold], at [0, 1]."] = "a:star:b",
) -> "System":
    raise SystemExit
"""


@pytest.mark.parametrize("verb", VERBS)
def test_help_shows_every_text_as_it_is_written(verb: str, tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text(WRITTEN)
    command = typer.main.get_command(build()).commands[verb]
    system = {"system", "options"} <= {param.name for param in command.params}
    lines = [(verb,), *((verb, each) for each in getattr(command, "commands", ()))]
    lines += [(verb, "quadrotor"), (verb, "mine.py:create")] if system else []
    for line in lines:
        shown = faultpath(*line, "--help").out
        assert not [c for c in shown if ord(c) > 0x2600], shown
        assert VERBS[verb].example.replace(" ", "")[:60] in "".join(shown.split()) or len(line) > 1
    if system:
        assert "file.py:factory: or [bold]x[/bold], at [0, 1]; default a:star:b" in shown
        assert "Options of mine.py:create" in shown


def test_the_version() -> None:
    assert faultpath("--version").out == f"faultpath {package.__version__}\n"


def test_python_m_is_the_command_and_imports_nothing_from_the_working_directory(tmp_path) -> None:
    (tmp_path / "typer.py").write_text("raise SystemExit('a stranger')")
    line = [sys.executable, "-m", "faultpath", "report", "nowhere"]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == faultpath("report", "nowhere").err
