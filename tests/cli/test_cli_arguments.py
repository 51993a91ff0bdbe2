"""Arguments that name nothing, or a number in other digits, for every option of every verb."""

import pytest
from cli_runs import TOY, audit, faultpath

from faultpath.core.errors import UserError
from faultpath.trials.question import CheckQuestion, ask


@pytest.mark.parametrize("option", ["primary", "metric", "library", "thresholds", "out", "seeds"])
def test_an_empty_value_is_refused_by_the_name_of_its_option(option: str) -> None:
    said = audit(**{option: ""}).refused()
    assert f"--{option}" in said
    assert "empty" in said
    assert f"--{option}=" in faultpath("audit", TOY, f"--{option}=").refused()


@pytest.mark.parametrize("text", [",", "a,", ",a", "a,,b", " ", "a,b,a", "a, a"])
def test_lists_of_names_hold_each_name_once_and_no_empty_one(text: str) -> None:
    with pytest.raises(UserError, match=r"empty name|'a' twice"):
        ask(CheckQuestion, {"variants": text})
    assert ask(CheckQuestion, {"variants": "a, b"}).variants == ("a", "b")


@pytest.mark.parametrize("verb", ["check", "map"])
def test_every_verb_with_a_list_refuses_empty_names(verb: str) -> None:
    option = "--against" if verb == "map" else "--variants"
    line = [verb, TOY, option, "blind,,calibrated"]
    if verb == "map":
        line += ["--baseline", "calibrated", "--repair", "blind", "--fault", "gain"]
    assert "empty name" in faultpath(*line).refused()


LIMITS = ["inf", "nan", "-1", "0", "-inf"]


@pytest.mark.parametrize("value", LIMITS)
@pytest.mark.parametrize("workers", [0, 1])
def test_a_time_limit_that_limits_nothing(value: str, workers: int, tmp_path) -> None:
    said = audit("--time-limit", value, workers=workers, out=tmp_path / "run").refused()
    assert "time" in said


def test_more_workers_than_any_machine_has_are_a_slip(tmp_path) -> None:
    assert "at most" in audit(workers="9" * 30, out=tmp_path / "run").refused()


@pytest.mark.parametrize("verb", ["check", "trace"])
def test_a_seed_that_no_table_holds(verb: str) -> None:
    assert "--seed" in faultpath(verb, TOY, "--seed", "9" * 30).refused()
