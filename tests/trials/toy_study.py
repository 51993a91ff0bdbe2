"""Studies of the toy system."""

from pathlib import Path

from faultpath.faults import Fault, Scale
from faultpath.trials.plan import Row, Study, SystemSpec, Treatment

SYSTEM = f"{Path(__file__).with_name('toy_system.py')}:create"
SCENES = tuple(f"s{i:02d}" for i in range(10))
FAULT = Fault(channel="mass", intervention=Scale(factor=0.6), onset_step=3)
PATHS = {
    "correct": (),
    "planner": (FAULT.aimed_at("planner.thrust"),),
    "shared": (FAULT.aimed_at("planner.thrust", "observer.balance"),),
}
UNITS = 2 * len(PATHS) * 2 * 3 - 2 * 3
"""Variants, paths, seeds and blocks; `plain` has one treatment for two of the paths (see
`rows`)."""


def rows() -> tuple[Row, ...]:
    """Every variant on every path; `plain` has no second reader, so `shared` is `planner`."""
    return tuple(
        Row(
            variant=variant,
            path=path,
            seed=seed,
            treatment=Treatment(
                variant=variant,
                faults=PATHS["planner" if (variant, path) == ("plain", "shared") else path],
                seed=seed,
            ),
        )
        for variant in ("plain", "observed")
        for path in PATHS
        for seed in (0, 1)
    )


def study(scenes: tuple[str, ...] = SCENES, name: str = "toy", **options: str) -> Study:
    return Study(
        name=name,
        system=SystemSpec(name=SYSTEM, options=options),
        library="ten",
        scenes=scenes,
        rows=rows(),
    )


def study_of(
    factory: str, scenes: tuple[str, ...] = SCENES, count: int = 1, **options: str
) -> Study:
    """Return the first rows of a study whose system this factory, `FILE:NAME`, builds."""
    whole = study(scenes, **options)
    system = whole.system.model_copy(update={"name": factory})
    return whole.model_copy(update={"system": system, "rows": whole.rows[:count]})
