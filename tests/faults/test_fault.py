"""Faults as data: who gets them and when, and the sentence for one that cannot act."""

import re
from collections.abc import Iterable

import pytest
from fault_toys import INTERFACE, calibration

from faultpath import faults as kinds
from faultpath.core.errors import UserError
from faultpath.faults import Fault, at_readers, parse_fault, resolve

SCALE = Fault(channel="mass", intervention=kinds.Scale(factor=1.1))


def aimed(*names: str) -> tuple[Fault, ...]:
    return tuple(fault.aimed_at(*names) for fault in calibration(0.1))


def reached(faults: Iterable[Fault]) -> dict[str, tuple[str, ...]]:
    return {fault.channel: fault.readers for fault in faults}


def test_faults_that_act_together_reach_whoever_reads_either_channel() -> None:
    assert reached(resolve(aimed("observer.wind_map"), INTERFACE)) == {
        "mass": ("observer.wind_map",)
    }
    assert reached(resolve(aimed("observer"), INTERFACE)) == {
        "mass": ("observer.wind_map",),
        "thrust": ("observer.model",),
    }


def test_readers_that_a_variant_lacks_are_left_out() -> None:
    plain = {"predictor.dynamics", "predictor.trim", "predictor.wind_map"}
    everywhere = resolve(calibration(0.1), INTERFACE)
    assert reached(at_readers(everywhere, plain)) == {
        "mass": ("predictor.dynamics", "predictor.trim"),
        "thrust": ("predictor.dynamics",),
    }
    assert resolve(calibration(0.1), INTERFACE, plain) == at_readers(everywhere, plain)
    assert at_readers(everywhere, {"observer"}) == resolve(aimed("observer"), INTERFACE)
    assert at_readers(at_readers(everywhere, {"observer"}), plain) == ()
    with pytest.raises(UserError, match=r"^fault 'mass scaled.* reaches no reader: here are predi"):
        resolve(aimed("observer"), INTERFACE, plain)


def test_faults_of_one_cause_share_it() -> None:
    together = parse_fault("calibration=0.1", INTERFACE, {"calibration": calibration}, 0.1)
    assert {fault.drawn_from for fault in together} == {"calibration"}
    assert resolve((SCALE,), INTERFACE)[0].drawn_from == "mass:scale"
    assert SCALE.aimed_at("observer").drawn_from == SCALE.drawn_from


@pytest.mark.parametrize(
    ("faults", "sentence"),
    [
        (
            [SCALE.model_copy(update={"channel": "mas"})],
            "unknown channel 'mas'; did you mean 'mass'?",
        ),
        (aimed("predictor.wind_map"), "channel 'mass' and channel 'thrust': "),
    ],
)
def test_a_fault_that_cannot_act_is_a_users_mistake(faults: list[Fault], sentence: str) -> None:
    with pytest.raises(UserError, match=re.escape(sentence)):
        resolve(faults, INTERFACE)


def test_a_fault_is_over_once_it_has_recovered() -> None:
    window = {"onset_step": 2, "duration_steps": 2, "recovery_steps": 3}
    fault = Fault(channel="mass", intervention=kinds.Freeze()).model_copy(update=window)
    assert [fault.over(step) for step in (6, 7)] == [False, True]
    assert [fault.weight(step) for step in (5, 6, 7)] == [0.5, 0.25, 0]
