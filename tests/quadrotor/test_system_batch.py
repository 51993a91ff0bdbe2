"""A trial's result is its own: neither neighbours nor their order enter it, to the bit."""

from collections.abc import Iterator

import pytest
from faultpath_quadrotor import native, system
from flights import HELD_OUT, bits, fault, fly, hall, quadrotor, with_halls

from faultpath.faults import AnyFault

STRONG_WIND = {"wind": "L3"}


@pytest.fixture(scope="module", params=["auto", native.PORTABLE], autouse=True)
def _path(request: pytest.FixtureRequest) -> Iterator[None]:
    """The law holds for compiled kernels and for torch alike."""
    for kept in (system._field, system._renderer):
        kept.cache_clear()
    with native.using(request.param):
        yield


pytestmark = pytest.mark.usefixtures("short")


NOISE = ("velocity:noise=0.2", "attitude:noise=0.05", "clearance:noise=0.1")
FAULTS = (*NOISE, "action:dropout=0.3,onset=4", "wind:delay=2")


@pytest.fixture(scope="module")
def faults() -> tuple[AnyFault, ...]:
    return tuple(fault(text) for text in FAULTS)


@pytest.fixture(scope="module")
def whole(_path, short, faults) -> dict[str, tuple[object, ...]]:
    outcomes, _ = fly(quadrotor(**STRONG_WIND), "dob", HELD_OUT, faults, seed=3)
    return {outcome.scene: bits(outcome) for outcome in outcomes}


@pytest.mark.parametrize("chosen", [(0,), (4,), (1, 3), (2, 0, 4, 3, 1), (3, 2, 1, 0)])
def test_any_selection_in_any_order_gives_what_the_whole_block_gives(chosen, whole, faults):
    scenes = [HELD_OUT[i] for i in chosen]
    outcomes, _ = fly(quadrotor(**STRONG_WIND), "dob", scenes, faults, seed=3)
    assert [outcome.scene for outcome in outcomes] == scenes
    assert {o.scene: bits(o) for o in outcomes} == {scene: whole[scene] for scene in scenes}


MANY = tuple(f"held-out/{i:03d}" for i in range(40))
OTHER_MODULES = {"predictor": "true-parameter", "sampler": "mode-preserving", "wind": "L3"}
OTHER_PLANNER = {"planner": "cem", "wind": "L3"}


@pytest.mark.parametrize(
    "options",
    [STRONG_WIND, OTHER_MODULES, OTHER_PLANNER],
    ids=["usual", "other modules", "other planner"],
)
def test_chunks_of_every_size_and_more_than_one_group_of_lanes_change_nothing(options, monkeypatch):
    """Scenes are planned in eights, fours, twos and ones, and flown in groups of 32 lanes."""
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", 5)
    system = quadrotor(**options)
    faults = [fault(text, system) for text in NOISE]
    block = {o.scene: bits(o) for o in fly(system, "dob", MANY, faults)[0]}
    for chosen in (MANY[33:34], MANY[20:35], MANY[38:31:-1], MANY[::13]):
        outcomes, _ = fly(system, "dob", chosen, faults)
        assert {o.scene: bits(o) for o in outcomes} == {scene: block[scene] for scene in chosen}


def test_neighbours_that_end_early_leave_the_others_alone(tmp_path):
    """Scenes are planned several at a time, and who flies with whom changes when one ends."""
    system = quadrotor(**STRONG_WIND)
    fast = hall(0, start=(0.0, 0.0, 1.5), goal=(0.0, 0.0, 0.995))
    low = hall(1, start=(0.0, 1.0, 0.3), goal=(4.0, 1.0, 1.5))
    near, under = with_halls(system, tmp_path, fast, low)
    alone, _ = fly(system, "dob", HELD_OUT)
    mixed, _ = fly(system, "dob", [near, *HELD_OUT[:3], under, *HELD_OUT[3:]])
    assert mixed[0].time_s < min(o.time_s for o in alone)
    assert bits(mixed[0]) == bits(fly(system, "dob", [near])[0][0])
    assert [bits(o) for o in mixed if o.scene in HELD_OUT] == [bits(o) for o in alone]

    falls = fault("action:erase@vehicle,onset=0,for=8", system)
    alone, _ = fly(system, "dob", HELD_OUT, [falls])
    mixed, _ = fly(system, "dob", [near, *HELD_OUT[:3], under, *HELD_OUT[3:]], [falls])
    ends = {o.scene: o.time_s for o in mixed}
    assert ends[near] < ends[under] < min(ends[scene] for scene in HELD_OUT)
    assert [bits(o) for o in mixed if o.scene in HELD_OUT] == [bits(o) for o in alone]
