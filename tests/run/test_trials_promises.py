"""Declarations of a system are looked at before anything flies, and a run keeps some."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from faultpath.core.errors import SystemMistake, UserError
from faultpath.run.plan import SystemSpec
from faultpath.run.registry import load_system
from faultpath.run.shown import SystemShown, system_shown
from faultpath.system import FloorPlan, Metric, Pillar, Prism, System
from faultpath.system.checks import check_system, library_of, paths_of

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


def test_a_library_is_the_one_that_was_asked_for(toy: type) -> None:
    assert library_of(toy(), "carts").name == "carts"
    with pytest.raises(UserError, match="no library 'cartz'"):
        library_of(toy(), "cartz")


PLAN = FloorPlan(
    low=(0.0, 0.0, 0.0),
    high=(4.0, 3.0, 2.0),
    prisms=(Prism(((1.0, 1.0), (2.0, 1.0), (2.0, 2.0)), 0.0, 1.5),),
    pillars=(Pillar(3.0, 1.0, 0.2, 0.0, 2.0),),
    start=(0.5, 0.5, 1.0),
    goal=(3.5, 2.5, 1.0),
    title="<corner>",
)


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch) -> System:
    system = load_system(SystemSpec(name=f"{EXAMPLES / 'toy.py'}:create"))
    monkeypatch.setattr(system, "floor_plan", lambda scene: PLAN if scene == "cart/001" else None)
    return system


def test_nothing_is_lost_on_the_way_through_the_file(planned: System) -> None:
    shown = system_shown(planned, ("calibrated", "blind"), ("cart/000", "cart/001"))
    assert SystemShown.model_validate_json(shown.model_dump_json()) == shown
    assert shown.interface == planned.interface
    assert shown.control_dt_s == planned.control_dt_s
    assert shown.plans == {"cart/001": PLAN}
    for variant in shown.variants:
        declared = planned.variants[variant.name]
        assert set(variant.readers) == declared.readers
        assert variant.bindings == dict(declared.bindings)


@pytest.mark.parametrize(
    ("plan", "says"),
    [
        (replace(PLAN, goal=(1.0, float("nan"), 0.0)), r"plans\.cart/000\..*goal"),
        (replace(PLAN, pillars=(replace(PLAN.pillars[0], radius=float("inf")),)), "radius"),
        (replace(PLAN, low="left"), "low"),
        (replace(PLAN, title=7), "title"),
        (Mute(), "a Mute"),
    ],
    ids=["not a number", "infinite", "text", "number", "no plan"],
)
def test_a_plan_that_cannot_be_drawn_is_the_systems_mistake(
    plan, says, planned, monkeypatch
) -> None:
    monkeypatch.setattr(planned, "floor_plan", lambda scene: plan)
    with pytest.raises(UserError, match=says):
        system_shown(planned, ("calibrated",), ("cart/000",))


@pytest.mark.parametrize(
    ("scenes", "stated", "size"),
    [
        (1, None, 20),
        (100, None, 20),
        (1280, None, 20),
        (1281, None, 21),
        (10_000, None, 157),
        (10**6, None, 500),
        (10_000, 3, 3),
        (100, 50, 50),
    ],
)
def test_the_size_of_a_block_follows_from_that_of_the_library(toy, scenes, stated, size) -> None:
    mine = type("Mine", (toy,), {"block_size": stated})()
    assert mine.scenes_a_block(scenes) == size
    assert System.scenes_a_block(mine, scenes) == (stated or 20)
