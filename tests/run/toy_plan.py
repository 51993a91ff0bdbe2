"""Plans of the toy system."""

from pathlib import Path

from faultpath.faults import Fault, Scale
from faultpath.run.plan import Plan, Row, SystemSpec, Treatment

SYSTEM = f"{Path(__file__).parents[1] / 'toys' / 'weighed.py'}:create"
SCENES = tuple(f"s{i:02d}" for i in range(10))
FAULT = Fault(channel="mass", intervention=Scale(factor=0.6), onset_step=3)
CONDITIONS = {
    "correct": (),
    "planner": (FAULT.aimed_at("planner.thrust"),),
    "shared": (FAULT.aimed_at("planner.thrust", "observer.balance"),),
}
UNITS = 2 * len(CONDITIONS) * 2 * 3 - 2 * 3
"""Variants, conditions, seeds and blocks; `plain` has one treatment for two of the conditions (see
`rows`)."""


def rows() -> tuple[Row, ...]:
    """Every variant on every condition; `plain` has no second reader, so `shared` is `planner`."""
    return tuple(
        Row(
            variant=variant,
            condition=condition,
            seed=seed,
            treatment=Treatment(
                variant=variant,
                faults=CONDITIONS[
                    "planner" if (variant, condition) == ("plain", "shared") else condition
                ],
                seed=seed,
            ),
        )
        for variant in ("plain", "observed")
        for condition in CONDITIONS
        for seed in (0, 1)
    )


def plan(scenes: tuple[str, ...] = SCENES, name: str = "toy", **options: str) -> Plan:
    return Plan(
        name=name,
        system=SystemSpec(name=SYSTEM, options=options),
        library="ten",
        scenes=scenes,
        rows=rows(),
    )


def plan_of(factory: str, scenes: tuple[str, ...] = SCENES, count: int = 1, **options: str) -> Plan:
    """Return the first rows of a plan whose system this factory, `FILE:NAME`, builds."""
    whole = plan(scenes, **options)
    system = whole.system.model_copy(update={"name": factory})
    return whole.model_copy(update={"system": system, "rows": whole.rows[:count]})
