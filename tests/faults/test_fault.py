"""Faults as data: who gets them and when, and the sentence for one that cannot act."""

import re
from typing import Any

import pytest
from fault_toys import INTERFACE, calibration

from faultpath import faults as kinds
from faultpath.core.errors import UserError
from faultpath.faults import Coupled, Fault

SCALE = Fault(channel="mass", intervention=kinds.Scale(factor=1.1))


def reached(fault: Fault | Coupled, present: Any = None) -> dict[str, tuple[str, ...]]:
    return {f.channel: f.consumers for f in fault.resolved(INTERFACE, present)}


def test_a_coupled_fault_reaches_whoever_reads_either_channel() -> None:
    assert reached(calibration(0.1).aimed_at("observer.wind_map")) == {
        "mass": ("observer.wind_map",)
    }
    assert reached(calibration(0.1).aimed_at("observer")) == {
        "mass": ("observer.wind_map",),
        "thrust": ("observer.model",),
    }


def test_consumers_that_a_variant_lacks_are_left_out() -> None:
    plain = {"predictor.dynamics", "predictor.trim", "predictor.wind_map"}
    assert reached(calibration(0.1), plain) == {
        "mass": ("predictor.dynamics", "predictor.trim"),
        "thrust": ("predictor.dynamics",),
    }
    assert reached(calibration(0.1).aimed_at("observer"), plain) == {}


def test_faults_of_one_cause_share_it() -> None:
    assert {f.drawn_from for f in calibration(0.1).resolved(INTERFACE)} == {"calibration"}
    assert SCALE.resolved(INTERFACE)[0].drawn_from == "mass:scale"
    assert SCALE.aimed_at("observer").drawn_from == SCALE.drawn_from


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (
            SCALE.model_copy(update={"channel": "mas"}),
            "unknown channel 'mas'; did you mean 'mass'?",
        ),
        (SCALE.aimed_at("predicter"), "unknown consumer 'predicter'; did you mean 'predictor'?"),
        (SCALE.aimed_at("observer.model"), "channel 'mass': 'observer.model' does not read it"),
        (calibration(0.1).aimed_at("predictor.wind_map"), "channel 'mass' and channel 'thrust': "),
        (
            Fault(channel="wind", intervention=kinds.Offset(by=(1.0, 2.0))),
            "by has shape [2] and the",
        ),
    ],
)
def test_a_fault_that_cannot_act_is_a_users_mistake(fault: Fault | Coupled, sentence: str) -> None:
    with pytest.raises(UserError, match=re.escape(sentence)):
        fault.resolved(INTERFACE)


def test_a_window_begins_ends_and_recovers() -> None:
    def weights(fault: Fault, steps: int) -> list[float]:
        return [fault.weight(step) for step in range(steps)]

    fault = Fault(channel="mass", intervention=kinds.Freeze(), onset_step=2)
    assert weights(fault, 5) == [0, 0, 1, 1, 1]
    fault = fault.model_copy(update={"duration_steps": 2})
    assert weights(fault, 6) == [0, 0, 1, 1, 0, 0]
    fault = fault.model_copy(update={"recovery_steps": 3})
    assert weights(fault, 8) == [0, 0, 1, 1, 0.75, 0.5, 0.25, 0]
    assert [fault.over(step) for step in (6, 7)] == [False, True]
