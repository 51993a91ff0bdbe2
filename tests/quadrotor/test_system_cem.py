"""The quadrotor under the cross-entropy method: the same loop, taps and laws."""

import pytest
from flights import HELD_OUT, bits, fault, fly, quadrotor

from faultpath.errors import UserError

STEPS = 4


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("faultpath.quadrotor.plant.module.CONTROL_STEPS", STEPS)


def test_every_iteration_asks_through_the_taps() -> None:
    system = quadrotor(planner="cem", iterations="3")
    _, taps = fly(system)
    for channel, consumer in (
        ("rollout", "planner.candidates"),
        ("clearance", "planner.risk_cost"),
    ):
        receipt = taps.receipts().at(channel, consumer)
        assert (receipt.deliveries, receipt.asks) == (STEPS, 3 * STEPS)


def test_a_scene_flies_alone_as_in_company_and_each_setting_its_own_way() -> None:
    system = quadrotor(planner="cem", wind="L2")
    both, _ = fly(system, scenes=HELD_OUT[:2])
    (alone,), _ = fly(system, scenes=HELD_OUT[1:2])
    assert bits(alone) == bits(both[1])
    others = [
        quadrotor(planner="cem", wind="L2", iterations="2"),
        quadrotor(planner="cem", wind="L2", elites="16"),
        quadrotor(wind="L2"),
    ]
    ends = [fly(other, scenes=HELD_OUT[1:2])[0][0] for other in others]
    assert len({bits(end)[-1] for end in (alone, *ends)}) == 4


def test_noise_on_the_clearance_differs_from_ask_to_ask() -> None:
    system = quadrotor(planner="cem")
    (plain,), _ = fly(system)
    (noisy,), taps = fly(system, faults=[fault("clearance:noise=1", system)])
    assert bits(noisy) != bits(plain)
    assert taps.receipts().at("clearance", "planner.risk_cost").steps_struck.tolist() == [STEPS]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"elites": "16"}, "elites belongs to planner cem"),
        ({"planner": "running", "iterations": "2"}, "iterations belongs to planner cem"),
        ({"planner": "cem", "sampler": "mode-preserving"}, "leave the sampler or the planner out"),
        ({"planner": "cem", "elites": "1000"}, "elites"),
    ],
)
def test_what_does_not_apply_is_refused(options: dict[str, str], said: str) -> None:
    with pytest.raises(UserError, match=said):
        quadrotor(**options)
