"""A system's own options as flags: shown with it, read with it, and of no other system."""

import json

import pytest
from cli_runs import TOY, audit, faultpath
from written import written

pytestmark = pytest.mark.usefixtures("without_pages")

QUADROTOR = ("wind", "environment", "clearance", "predictor", "planner", "bring", "device")

CREATE = """
from typing import Annotated, Literal
Gear = Annotated[Literal["low", "high"], "Gear of the cart."]
def create(gear: Gear = "low", steps: int = 3, scenes: str = "") -> Mine:
    assert isinstance(steps, int)
    return Mine()
"""


@pytest.fixture(autouse=True)
def _mine(tmp_path):
    written(tmp_path, create=CREATE)


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        (("audit", TOY, "--sceens", "3"), "--scenes"),
        (("check", "quadrotor", "--seeed", "1"), "--seed"),
        (("audit", "mine.py:create", "--geer", "low"), "--gear"),
        (("train", "quadrotor", "--wrkers", "1"), "--workers"),
    ],
)
def test_a_misspelt_option_is_answered_with_the_one_that_was_meant(line, meant):
    assert "Possible" not in faultpath(*line).refused(f"did you mean {meant}?")


def test_an_option_of_a_system_before_its_name_is_told_its_place():
    ended = faultpath("trace", "--gear", "low", "mine.py:create")
    ended.refused("no option --gear", "those of a system stand after its name")


@pytest.mark.parametrize("verb", ["audit", "trace"])
def test_help_shows_the_options_of_the_system_that_is_named(verb):
    shown = faultpath(verb, "quadrotor", "--help").out
    assert "Options of quadrotor" in shown
    assert all(f"--{name} " in shown for name in QUADROTOR)
    for other in ((verb, "--help"), (verb, "nowhere.py:x", "--help")):
        ended = faultpath(*other)
        assert ended.status == 0
        assert "--set" in ended.out
        assert "Options of" not in ended.out
        assert not any(f"--{name} " in ended.out for name in QUADROTOR)
    mine = faultpath(verb, "mine.py:create", "--help").out
    assert "Options of mine.py:create" in mine
    assert "Gear of the cart; default low." in mine
    assert "<low|high>" in mine


def test_a_flag_is_what_set_would_be(tmp_path):
    line = {"system": "mine.py:create", "scenes": 2}
    assert audit("--gear", "high", "--steps=4", out="one", **line).status == 0
    assert audit("--set", "gear=high", "--set", "steps=4", out="two", **line).status == 0
    records = [json.loads((tmp_path / name / "record.json").read_text()) for name in ("one", "two")]
    assert records[0] == records[1]
    assert records[0]["question"]["options"] == {"gear": "high", "steps": "4"}


def test_a_flag_of_the_verb_keeps_its_meaning():
    assert audit("--set", "scenes=x", system="mine.py:create", scenes=2, out="run").status == 0


@pytest.mark.parametrize(
    ("arguments", "options", "names"),
    [
        (["--wnd", "L3"], {"system": "quadrotor"}, ["--wnd", "--wind, --environment"]),
        (["--wind=L3"], {}, ["--wind", "toy.py:create", "takes none"]),
        (["--gear", "3"], {"system": "mine.py:create"}, ["'3'", "low, high"]),
        (["--steps", "x"], {"system": "mine.py:create"}, ["steps 'x'", "whole number"]),
        (["--gear", "low", "--set", "gear=low"], {"system": "mine.py:create"}, ["'gear' twice"]),
        (["--wind", "L3"], {"system": "quadcopter"}, ["no system 'quadcopter'"]),
    ],
)
def test_a_wrong_flag_is_told_in_a_sentence(arguments, options, names, tmp_path):
    audit(*arguments, **options).refused(*names)
    assert {path.name for path in tmp_path.iterdir()} <= {"mine.py", "__pycache__"}
