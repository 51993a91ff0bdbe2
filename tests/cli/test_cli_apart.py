"""Prints and working directories of a system are its own affair, and no part of a command."""

import json
import os
from pathlib import Path

import pytest
from cli_runs import audit, audit_line, faultpath
from written import written

ENTERS = """import os
Path("own").mkdir(exist_ok=True)
os.chdir("own")
data_files = ("own/drag.txt",)
def run(self, *asked):
    assert Path("drag.txt").read_text() == "1"
    self.os.chdir("/")
    return super().run(*asked)"""
PRINTS = """def run(self, *asked):
    print("wind: 3 m/s")
    return super().run(*asked)"""


@pytest.mark.parametrize("workers", [0, 1])
def test_a_system_that_enters_a_folder_runs_there_and_moves_nothing_else(
    workers: int, tmp_path: Path
) -> None:
    written(tmp_path, ENTERS)
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "drag.txt").write_text("1")
    files = ["--junit", "junit.xml", "--summary", "summary.md", "--no-signals"]
    ended = audit(*files, system="mine.py", out="run", workers=workers)
    assert (ended.status, Path.cwd()) == (0, tmp_path), ended.err
    assert "\nReport: run/report.html\n" in ended.out
    assert (tmp_path / "run" / "report.html").is_file()
    assert {"junit.xml", "summary.md"} <= set(os.listdir(tmp_path))


def test_a_folder_that_a_broken_system_entered_is_left(tmp_path: Path) -> None:
    broken = written(tmp_path, "import os; os.chdir('/'); 1 / 0")
    audit(system=broken).refused("mine.py, line 10: ZeroDivisionError")
    assert Path.cwd() == tmp_path


def test_what_a_system_prints_is_no_json(tmp_path: Path) -> None:
    prints = written(tmp_path, PRINTS)
    place = ["--library", "carts"]
    for line in (
        audit_line("--json", "--no-signals", system=prints, out="run", scenes=2),
        ["trace", prints, *place, "--json"],
        ["check", prints, *place, "--scenes", 1, "--workers", 0, "--json"],
        ["replay", "run", "--where", "--json", "--trust"],
    ):
        ended = faultpath(*line)
        assert ended.status == 0, ended.err
        assert json.loads(ended.out)
        assert "wind: 3 m/s" in ended.err
