"""No number of a result changes by a bit unless `numbers.json` is written anew on purpose."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from golden_cases import AUDITS, HERE, JUDGED, MAPS, NUMBERS, PAPER, cases

STORED = json.loads(NUMBERS.read_text())
NAMES = [name for name, _ in cases(Path())]


def test_every_case_is_stored_once() -> None:
    assert len(set(NAMES)) == len(AUDITS) + len(MAPS) + len(JUDGED) + PAPER
    assert [name for name in STORED if PAPER or name != "paper"] == NAMES


def test_the_cases_hold_what_stored_runs_lack() -> None:
    judged = [STORED[name] for name in NAMES if name.startswith("judge")]
    audits = [STORED[name] for name in NAMES if name.startswith("audit")]
    effects = [effect for case in judged + audits for effect in case["effects"].values()]
    changes = [change for case in judged + audits for change in case["changes"].values()]
    assert {effect["sign"] for effect in effects} == {-1, 0, 1}
    assert {change["turn"] for change in changes} >= {"none", "interaction", "reversal"}
    assert any(effect["failed"] and effect["failed"]["unsettled"] for effect in effects)
    assert any(effect["failed"] and effect["failed"]["uneven"] for effect in effects)
    assert {case["invalid"] for case in judged} == {None, "unpaired"}
    assert {case["stopped"]["reached"] for case in audits if case["stopped"]} == {True, False}
    kinds = {entry["kind"] for case in judged + audits for entry in case["break_even"].values()}
    assert kinds >= {"interval", "empty", "whole"}


@pytest.mark.slow
def test_numbers_are_the_stored_ones_to_the_bit(tmp_path: Path) -> None:
    """In a process of its own: which instructions libraries use is settled when it starts."""
    program, target = HERE / "golden_cases.py", tmp_path / "numbers.json"
    done = subprocess.run([sys.executable, program, target], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    numbers = json.loads(target.read_text())
    assert [name for name in NAMES if numbers[name] != STORED[name]] == []
