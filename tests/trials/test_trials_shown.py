"""What a run keeps of its system for whoever reads the folder without it."""

from dataclasses import replace
from pathlib import Path

import pytest

from faultpath.core.errors import UserError
from faultpath.trials import (
    FloorPlan,
    Pillar,
    Prism,
    System,
    SystemShown,
    SystemSpec,
    load_system,
    system_shown,
)

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
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
def toy(monkeypatch: pytest.MonkeyPatch) -> System:
    system = load_system(SystemSpec(name=f"{EXAMPLES / 'toy.py'}:create"))
    monkeypatch.setattr(system, "floor_plan", lambda scene: PLAN if scene == "cart/001" else None)
    return system


def test_nothing_is_lost_on_the_way_through_the_file(toy: System) -> None:
    shown = system_shown(toy, ("calibrated", "blind"), ("cart/000", "cart/001"))
    assert SystemShown.model_validate_json(shown.model_dump_json()) == shown
    assert shown.interface == toy.interface
    assert shown.control_dt_s == toy.control_dt_s
    assert shown.plans == {"cart/001": PLAN}
    for variant in shown.variants:
        declared = toy.variants[variant.name]
        assert set(variant.consumers) == declared.consumers
        assert variant.bindings == dict(declared.bindings)


@pytest.mark.parametrize(
    ("plan", "says"),
    [
        (replace(PLAN, goal=(1.0, float("nan"), 0.0)), "goal"),
        (replace(PLAN, pillars=(replace(PLAN.pillars[0], radius=float("inf")),)), "radius"),
        (replace(PLAN, low="left"), "low"),
        (replace(PLAN, title=7), "title"),
    ],
    ids=["not a number", "infinite", "text", "number"],
)
def test_a_plan_that_cannot_be_drawn_is_the_systems_mistake(plan, says, toy, monkeypatch) -> None:
    monkeypatch.setattr(toy, "floor_plan", lambda scene: plan)
    with pytest.raises(UserError, match=rf"plans\.cart/000\..*{says}"):
        system_shown(toy, ("calibrated",), ("cart/000",))
