"""No number of a result changes by a bit unless `numbers.json` is written anew on purpose."""

import json
from pathlib import Path

import pytest
from golden_cases import AUDITS, JUDGED, MAPS, NUMBERS, cases, plain

STORED = json.loads(NUMBERS.read_text())
NAMES = [name for name, _ in cases(Path())]


def test_every_case_is_stored_once() -> None:
    assert len(set(NAMES)) == len(AUDITS) + len(MAPS) + len(JUDGED) + 1
    assert list(STORED) == NAMES


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


@pytest.mark.parametrize("name", NAMES)
def test_numbers_are_the_stored_ones_to_the_bit(name: str, tmp_path: Path) -> None:
    assert plain(dict(cases(tmp_path))[name]()) == STORED[name]
