"""What a system declares is looked at before anything flies, whatever its objects do when asked."""

import sys
from pathlib import Path

import pytest

from faultpath.core.errors import SystemMistake, UserError
from faultpath.trials import Metric, SystemSpec, load_system
from faultpath.trials.checks import check_system, library_of, paths_of
from faultpath.trials.shown import system_shown

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


class Mute:
    """Fails at what every object can."""

    def __str__(self) -> str:
        raise RuntimeError("no words")

    __repr__ = __str__


def failing(self: object) -> object:
    raise ValueError("of two\nlines\x1b[31m")


@pytest.fixture(scope="module")
def toy() -> type:
    sys.path.append(str(EXAMPLES))
    try:
        from toy import Toy
    finally:
        sys.path.remove(str(EXAMPLES))
    return Toy


PROMISED = (
    *("name", "control_dt_s", "block_size", "parallel", "trained", "time_limit_s"),
    *("interface", "metrics", "ends", "fault_presets", "variants"),
)


@pytest.mark.parametrize("attribute", PROMISED)
@pytest.mark.parametrize(
    "value",
    [Mute(), property(failing), b"\xff", float("nan"), {Mute(): Mute()}, []],
    ids=["mute", "fails", "bytes", "nan", "mute mapping", "list"],
)
def test_what_is_declared_wrongly_is_named(toy: type, attribute: str, value: object) -> None:
    mine = type("Mine", (toy,), {attribute: value})()
    with pytest.raises(SystemMistake) as refused:
        check_system(mine, "mine.py:create")
    said = str(refused.value)
    assert attribute in said
    assert said.isprintable()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("missed m", "metric 'missed m' has ' ' in its name: use small letters"),
        ("Missed", "has 'M' in its name"),
        ("2nd", "has '2' in its name"),
        ("", "has no name"),
        ("time_s", "metric 'time_s' is a column of the table: rename it"),
    ],
)
def test_the_odd_character_of_a_metric_is_shown(toy: type, name: str, said: str) -> None:
    metrics = {name: Metric(unit="m", better="less")}
    with pytest.raises(SystemMistake) as refused:
        check_system(type("Mine", (toy,), {"metrics": metrics})(), "mine.py:create")
    assert said in str(refused.value)


@pytest.mark.parametrize("attribute", ["data_files", "parts"])
@pytest.mark.parametrize("value", [None, 3, "one", (3,), Mute(), property(failing)])
def test_paths_that_are_none_are_named(toy: type, attribute: str, value: object) -> None:
    with pytest.raises(SystemMistake, match=f"`{attribute}`"):
        paths_of(type("Mine", (toy,), {attribute: value})(), attribute)


def test_a_floor_plan_that_is_none_is_refused(toy: type) -> None:
    mine = type("Mine", (toy,), {"floor_plan": lambda self, scene: Mute()})()
    with pytest.raises(SystemMistake, match="a Mute"):
        system_shown(mine, ("blind",), ("cart/000",))


@pytest.mark.parametrize(
    "name",
    [
        *("builtins:dict", "builtins:exit", "builtins:object", "builtins:type", "json:loads"),
        *("math:sqrt", "typing:Any", "enum:Enum", "threading:Thread", "abc:ABC"),
    ],
)
def test_what_builds_no_system_is_a_sentence(name: str) -> None:
    with pytest.raises(UserError):
        load_system(SystemSpec(name=name))


def test_a_library_is_the_one_that_was_asked_for(toy: type) -> None:
    assert library_of(toy(), "carts").name == "carts"
    with pytest.raises(UserError, match="no library 'cartz'"):
        library_of(toy(), "cartz")
