"""A trial's result is its own: neither neighbours nor their order enter it, to the bit.

The law of everything that flies: geometry, field and camera, estimators, predictors, planners.
"""

from collections.abc import Iterator

import pytest
from faultpath_quadrotor import native, system
from flights import HELD_OUT, bits, fault, fly, hall, quadrotor, with_halls


@pytest.fixture(scope="module", params=["auto", native.PORTABLE], autouse=True)
def _path(request: pytest.FixtureRequest) -> Iterator[None]:
    """The law holds for compiled kernels and for torch alike."""
    for kept in (system._field, system._renderer):
        kept.cache_clear()
    with native.using(request.param):
        yield


MANY = tuple(f"held-out/{i:03d}" for i in range(33))
NOISE = ("velocity:noise=0.2", "attitude:noise=0.05", "clearance:noise=0.1")
FAULTS = (*NOISE, "action:dropout=0.3,onset=1", "wind:delay=1")
LEARNED = {"predictor": "wm-a-wind", "clearance": "depth", "wind": "L3"}
TRUE = {"predictor": "true-parameter", "sampler": "mode-preserving"}
MODULES = {
    "analytic, cross-entropy": ({"planner": "cem"}, "dob", FAULTS, 3),
    "true parameters": (TRUE, "dob", NOISE, 3),
    "learned, filtered": (LEARNED | {"estimator": "eskf"}, "gru", NOISE, 3),
    "unanchored": (LEARNED, "wm-u", NOISE, 2),
}


@pytest.mark.parametrize(("options", "variant", "texts", "steps"), MODULES.values(), ids=MODULES)
def test_who_is_flown_beside_a_scene_and_in_which_order_changes_nothing(
    options, variant, texts, steps, monkeypatch
):
    """Scenes are planned in chunks of any size up to 13, and flown in groups of 32 lanes."""
    monkeypatch.setattr("faultpath_quadrotor.plant.module.CONTROL_STEPS", steps)
    flyer = quadrotor(**{"wind": "L3"} | options)
    faults = [part for text in texts for part in fault(text, flyer)]
    block = {o.scene: bits(o) for o in fly(flyer, variant, MANY, faults, seed=2)[0]}
    for chosen in (MANY[32:], MANY[31:17:-1], MANY[::13]):
        outcomes, _ = fly(flyer, variant, chosen, faults, seed=2)
        assert [outcome.scene for outcome in outcomes] == list(chosen)
        assert {o.scene: bits(o) for o in outcomes} == {scene: block[scene] for scene in chosen}


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("text", ["action:scale=1", "action:erase@vehicle,onset=0,for=8"])
def test_neighbours_that_end_early_leave_the_others_alone(text, tmp_path):
    """Scenes are planned several at a time, and who flies with whom changes when one ends."""
    flyer = quadrotor(wind="L3")
    fast = hall(0, start=(0.0, 0.0, 1.5), goal=(0.0, 0.0, 0.995))
    low = hall(1, start=(0.0, 1.0, 0.3), goal=(4.0, 1.0, 1.5))
    near, under = with_halls(flyer, tmp_path, fast, low)
    faults = fault(text, flyer)
    alone, _ = fly(flyer, "dob", HELD_OUT, faults)
    mixed, _ = fly(flyer, "dob", [near, *HELD_OUT[:3], under, *HELD_OUT[3:]], faults)
    ends = {o.scene: o.time_s for o in mixed}
    assert ends[near] < min(ends[scene] for scene in HELD_OUT)
    assert ends[near] < ends[under]
    assert bits(mixed[0]) == bits(fly(flyer, "dob", [near], faults)[0][0])
    assert [bits(o) for o in mixed if o.scene in HELD_OUT] == [bits(o) for o in alone]
