"""The delivery log: what was delivered, where a fault acted, and what is an error."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from libraries import LIBRARIES, to_torch
from tap_toys import make

from faultpath.faults import Fault, Scale
from faultpath.loop import FaultedElsewhere, NotDelivered, Reading, Taps
from faultpath.loop.corruption import corruptions

DOUBLE = Fault(channel="mass", intervention=Scale(factor=2.0))
LATE = DOUBLE.model_copy(update={"onset_step": 3, "duration_steps": 2}).aimed_at("observer")


def run(taps: Taps, to: Any = np.asarray, steps: Any = range(6), zero: int = -1) -> None:
    for step in steps:
        value = to(np.array([0.0, 0.0] if step == zero else [1.0, 2.0]))
        for reader in ("predictor.dynamics", "observer.model"):
            taps.deliver("mass", reader, Reading(value, "scale", step), step)


@LIBRARIES
def test_counts_deliveries_and_steps(to: Any) -> None:
    taps = make([LATE])
    run(taps, to, range(2, 6))
    faulted = taps.delivery_log().at("mass", "observer.model")
    assert faulted.deliveries == 4
    assert faulted.steps_faulted.tolist() == [2, 2]
    assert faulted.steps_altered.tolist() == [2, 2]
    (fault,) = faulted.faults
    assert fault.fault == "mass scaled by 2 at observer.model from step 3 for 2 steps"
    clean = taps.delivery_log().at("mass", "predictor.dynamics")
    assert (clean.deliveries, clean.faults, clean.steps_faulted.tolist()) == (4, (), [0, 0])
    silent = taps.delivery_log().at("wind", "planner.wind")
    assert silent.deliveries == 0


@LIBRARIES
def test_faulted_is_not_yet_altered(to: Any) -> None:
    taps = make([LATE.model_copy(update={"onset_step": 1})])
    run(taps, to, zero=2)
    tap = taps.delivery_log().at("mass", "observer.model")
    assert tap.steps_faulted.tolist() == [2, 2]
    assert tap.steps_altered.tolist() == [1, 1]


@LIBRARIES
def test_a_nan_that_stays_is_not_altered(to: Any) -> None:
    taps = make([DOUBLE])
    for step, lost in enumerate((0.0, np.nan)):
        reading = Reading(to(np.array([lost, 1.0])), "scale", step)
        taps.deliver("mass", "observer.model", reading, step)
    assert taps.delivery_log().steps_altered.tolist() == [0, 2]


@LIBRARIES
@pytest.mark.parametrize("mask_to", [np.asarray, to_torch])
def test_only_running_scenes_count(to: Any, mask_to: Any) -> None:
    taps = make([LATE.model_copy(update={"onset_step": 1, "duration_steps": None})])
    run(taps, to, range(3))
    taps.set_active(mask_to(np.array([True, False])))
    run(taps, to, range(3, 5))
    taps.set_active(None)
    run(taps, to, range(5, 6))
    assert taps.delivery_log().steps_faulted.tolist() == [5, 3]
    assert taps.delivery_log().steps_altered.tolist() == [5, 3]


@LIBRARIES
def test_a_step_counts_once_for_the_run_however_many_taps_are_faulted(to: Any) -> None:
    taps = make([LATE.aimed_at("*")])
    run(taps, to)
    assert taps.delivery_log().steps_faulted.tolist() == [2, 2]


def test_two_faults_at_a_tap_are_told_apart() -> None:
    early = LATE.model_copy(update={"onset_step": 0, "duration_steps": 4})
    taps = make([early, LATE])
    run(taps)
    tap = taps.delivery_log().at("mass", "observer.model")
    assert [s.steps_in_force.tolist() for s in tap.faults] == [[4, 4], [2, 2]]
    assert tap.steps_faulted.tolist() == [5, 5]


@pytest.mark.parametrize(
    ("steps", "last"),
    [(range(3), [2, 2]), (range(4), [3, 1])],
    ids=["both ended before the onset", "one ended before it"],
)
def test_a_fault_that_missed_some_scenes_is_no_error(steps: Any, last: list[int]) -> None:
    taps = make([LATE])
    run(taps, steps=steps)
    taps.verify(np.array(last))


@pytest.mark.parametrize("steps", [(), (0,), (0, 5)])
def test_a_fault_that_never_came_to_bear_is_an_error(steps: tuple[int, ...]) -> None:
    taps = make([LATE])
    run(taps, steps=steps)
    with pytest.raises(NotDelivered, match=r"never reached it, although 1 of 2 scenes ran past"):
        taps.verify(np.array([5, 2]))


def test_one_of_two_faults_that_never_came_to_bear_is_an_error() -> None:
    taps = make([LATE.model_copy(update={"onset_step": 0}), LATE])
    run(taps, steps=[0])
    with pytest.raises(NotDelivered, match="from step 3"):
        taps.verify(5)


def test_a_fault_that_reached_another_is_an_error() -> None:
    taps = make([LATE])
    run(taps)
    log = taps.delivery_log()
    with pytest.raises(FaultedElsewhere, match=re.escape("tap mass -> observer.model altered a")):
        log.check({})
    named = {("mass", "observer.model"): [log.at("mass", "observer.model").faults[0].fault]}
    log.check(named)
    early = LATE.model_copy(update={"onset_step": 0})
    both = make([early, LATE])
    run(both)
    with pytest.raises(FaultedElsewhere, match=re.escape("tap mass -> observer.model altered a")):
        both.delivery_log().check(named)
    once = {"mass": {}, "wind": {"steps_altered": np.array([1, 0])}}
    strange = tuple(replace(tap, **once[tap.channel]) for tap in log.taps)
    with pytest.raises(FaultedElsewhere, match=re.escape("tap wind -> predictor.wind altered a")):
        replace(log, taps=strange).check(named)


@pytest.mark.parametrize(
    ("reached", "error", "sentence"),
    [
        ((), NotDelivered, "tap mass -> observer.model: '.*' names it, but did not act there"),
        (
            ("predictor.dynamics",),
            FaultedElsewhere,
            "tap mass -> predictor.dynamics altered a reading, but no fault names it",
        ),
        (
            ("predictor.dynamics", "observer.model"),
            FaultedElsewhere,
            "tap mass -> predictor.dynamics altered a reading, but no fault names it",
        ),
    ],
)
def test_taps_that_attach_a_fault_elsewhere_are_told_by_the_faults(
    monkeypatch: pytest.MonkeyPatch, reached: tuple[str, ...], error: type[Exception], sentence: str
) -> None:
    def misplaced(faults: Any, *more: Any) -> Any:
        return corruptions(
            (fault.model_copy(update={"readers": reached}) for fault in faults), *more
        )

    monkeypatch.setattr("faultpath.loop.taps.corruptions", misplaced)
    taps = make([LATE])
    run(taps)
    with pytest.raises(error, match=sentence):
        taps.verify(5)


def test_one_of_two_faults_that_is_not_attached_is_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "faultpath.loop.taps.corruptions", lambda faults, *more: corruptions(faults[:1], *more)
    )
    taps = make([LATE.model_copy(update={"onset_step": 0}), LATE])
    run(taps)
    with pytest.raises(NotDelivered, match=r"from step 3 .* names it, but did not act there"):
        taps.verify(5)
