"""Faults as data: who gets them, when, in words and in JSON."""

import re
from typing import Any

import pytest
from fault_toys import INTERFACE, calibration
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from faultpath.core.errors import UserError
from faultpath.faults import (
    ALL,
    AnyFault,
    Bias,
    Coupled,
    Delay,
    Drift,
    Dropout,
    Erase,
    Fault,
    Freeze,
    Hold,
    Noise,
    Offset,
    Quantise,
    Rotate,
    Scale,
    Sequence,
    Shuffle,
    UniformScale,
)

reals = st.floats(-1e6, 1e6)
constants = reals | st.tuples(reals, reals, reals) | st.tuples(st.tuples(reals, reals))
counts = st.integers(1, 50)
simple = st.one_of(
    st.builds(Scale, factor=constants),
    st.builds(UniformScale, half_range=st.floats(0, 0.9)),
    st.builds(Offset, by=constants),
    st.builds(Rotate, by=st.tuples(reals, reals, reals)),
    st.builds(Quantise, step_size=st.floats(1e-3, 10)),
    st.builds(Erase, default=st.none() | constants),
    st.builds(Noise, std=st.floats(0, 10), relative=st.booleans()),
    st.builds(Drift, rate_per_s=constants, walk_per_sqrt_s=st.floats(0, 10)),
    st.builds(Bias, std=st.floats(0, 10), time_constant_s=st.none() | st.floats(0.1, 10)),
    st.builds(Delay, steps=counts),
    st.builds(Hold, every=counts),
    st.builds(Freeze),
    st.builds(
        Dropout,
        probability=st.floats(0, 1),
        substitute=st.none() | st.builds(Erase, default=st.none() | reals),
    ),
    st.builds(Shuffle, axis=st.integers(1, 3)),
)
interventions = st.recursive(
    simple,
    lambda inner: st.builds(Sequence, parts=st.lists(inner, min_size=1, max_size=2).map(tuple)),
    max_leaves=3,
)
faults = st.builds(
    Fault,
    channel=st.just("mass"),
    intervention=interventions,
    consumers=st.sampled_from([(ALL,), ("predictor",), ("predictor.trim", "observer")]),
    onset_step=counts,
    duration_steps=counts,
    recovery_steps=st.integers(0, 9),
    cause=st.none() | st.just("storm"),
)


@given(
    faults
    | st.builds(
        lambda fs: Coupled(name="two", faults=tuple(fs)), st.lists(faults, min_size=1, max_size=2)
    )
)
def test_json_round_trip_is_exact(fault: Fault | Coupled) -> None:
    again = TypeAdapter(AnyFault).validate_json(fault.model_dump_json())
    assert again == fault
    assert hash(again) == hash(fault)


SCALE = Fault(channel="mass", intervention=Scale(factor=1.1))


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


def test_erasure_takes_the_channels_default() -> None:
    [fault] = Fault(channel="wind", intervention=Erase()).resolved(INTERFACE)
    assert fault.intervention == Erase(default=(0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (
            SCALE.model_copy(update={"channel": "mas"}),
            "interface toy: unknown channel 'mas'; did you mean 'mass'? known: mass, thrust, wind",
        ),
        (
            SCALE.aimed_at("predicter"),
            "channel 'mass': unknown consumer 'predicter'; did you mean 'predictor'? known: "
            "observer, observer.wind_map, predictor, predictor.dynamics, predictor.trim",
        ),
        (
            SCALE.aimed_at("observer.model"),
            "channel 'mass': 'observer.model' does not read it; its readers: observer, "
            "observer.wind_map, predictor, predictor.dynamics, predictor.trim",
        ),
        (
            calibration(0.1).aimed_at("predictor.wind_map"),
            "channel 'mass' and channel 'thrust': 'predictor.wind_map' does not read it; its "
            "readers: observer, observer.model, observer.wind_map, predictor, predictor.dynamics, "
            "predictor.trim",
        ),
        (
            Fault(channel="wind", intervention=Offset(by=(1.0, 2.0))),
            "channel 'wind': offset does not fit: by has shape [2] and the reading of one scene "
            "has [3]",
        ),
    ],
)
def test_a_fault_that_cannot_act_is_a_users_mistake(fault: Fault | Coupled, sentence: str) -> None:
    with pytest.raises(UserError, match=f"^{re.escape(sentence)}$"):
        fault.resolved(INTERFACE)


def test_a_window_begins_ends_and_recovers() -> None:
    def weights(fault: Fault, steps: int) -> list[float]:
        return [fault.weight(step) for step in range(steps)]

    fault = Fault(channel="mass", intervention=Freeze(), onset_step=2)
    assert weights(fault, 5) == [0, 0, 1, 1, 1]
    fault = fault.model_copy(update={"duration_steps": 2})
    assert weights(fault, 6) == [0, 0, 1, 1, 0, 0]
    fault = fault.model_copy(update={"recovery_steps": 3})
    assert weights(fault, 8) == [0, 0, 1, 1, 0.75, 0.5, 0.25, 0]
    assert [fault.over(step) for step in (6, 7)] == [False, True]
