"""Delivery: what a consumer may read, and what it gets."""

import re
from typing import Any

import numpy as np
import pytest
from libraries import to_torch
from tap_toys import make

from faultpath.core.errors import UserError
from faultpath.faults import Fault, Freeze, Offset, Quantise, Scale
from faultpath.loop import IllegalRead, MalformedReading, Reading, UndeclaredReader

SCALE = Fault(channel="mass", intervention=Scale(factor=2.0), consumers=("observer",))


def mass(step: int, value: Any = None, source: str = "scale") -> Reading:
    return Reading(np.array([1.0, 3.0]) if value is None else value, source, step)


def test_without_a_fault_the_consumer_gets_the_very_tensor() -> None:
    taps = make([SCALE])
    value = to_torch([1.0, 3.0])
    assert taps.deliver("mass", "predictor.dynamics", mass(0, value), 0) is value


def test_only_the_faulted_consumer_gets_another_value() -> None:
    taps = make([SCALE])
    assert taps.deliver("mass", "observer.model", mass(0), 0).tolist() == [2.0, 6.0]
    assert taps.deliver("mass", "predictor.dynamics", mass(0), 0).tolist() == [1.0, 3.0]


STILL, WIND = mass(0, source="still"), Reading(np.zeros((2, 3)), "truth", 0)
FEWER, TRUE = make(consumers={"predictor.dynamics"}), make(bindings={"wind": "truth"})


@pytest.mark.parametrize(
    ("taps", "tap", "reading", "error", "said"),
    [
        (make(), "mass -> planner.wind", mass(0), UndeclaredReader, "does not declare this"),
        (FEWER, "mass -> observer.model", mass(0), UndeclaredReader, "this variant has no such"),
        (make(), "mass -> observer.model", STILL, IllegalRead, "'still', but the channel is bound"),
        (TRUE, "wind -> planner.wind", WIND, IllegalRead, "source 'truth' is privileged"),
        (make(), "mass -> observer.model", mass(1), IllegalRead, "which is after step 0"),
    ],
)
def test_an_illegal_read_names_the_tap(taps, tap, reading, error, said):
    channel, consumer = tap.split(" -> ")
    with pytest.raises(error, match=f"^tap {tap}: .*{re.escape(said)}"):
        taps.deliver(channel, consumer, reading, 0)


def test_steps_do_not_run_backwards() -> None:
    taps = make()
    taps.deliver("mass", "observer.model", mass(0), 3)
    with pytest.raises(MalformedReading, match="step 2 comes after step 3; a new run needs new"):
        taps.deliver("mass", "observer.model", mass(0), 2)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"bindings": {"wnd": "still"}}, "unknown channel 'wnd'; did you mean 'wind'"),
        ({"bindings": {"wind": "scale"}}, "channel 'wind' cannot be bound: unknown source 'scale'"),
        ({"privileged": {"oracle"}}, "unknown source 'oracle'"),
        ({"consumers": {"pilot.x"}}, "this variant's consumers: unknown consumer 'pilot.x'"),
        ({"faults": [SCALE.aimed_at("pilot")]}, "channel 'mass': unknown consumer 'pilot'"),
        (
            {"faults": [SCALE], "consumers": {"predictor.dynamics"}},
            "fault 'mass scaled by 2 at observer' reaches no consumer",
        ),
    ],
)
def test_wrong_names_are_a_users_mistake(given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=re.escape(sentence)):
        make(**given)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"intervention": Quantise(step_size=0.5)}, "quantise turns int64 [2] into float64 [2]"),
        (
            {"intervention": Freeze(), "duration_steps": 1, "recovery_steps": 1},
            "freeze cannot recover step by step in int64",
        ),
    ],
)
def test_whole_numbers_are_not_turned_into_others(changes: dict[str, Any], says: str) -> None:
    taps = make([SCALE.model_copy(update=changes)])
    whole = np.array([1, 2])
    with pytest.raises(UserError, match=re.escape(f"fault on channel 'mass': {says}")):
        [taps.deliver("mass", "observer.model", mass(step, whole), step) for step in range(2)]


class TestModuleView:
    def test_delivers_to_its_own_places_only(self) -> None:
        view = make([SCALE]).for_module("observer")
        assert view.deliver("mass", "model", mass(0), 0).tolist() == [2.0, 6.0]
        with pytest.raises(UndeclaredReader, match=re.escape("mass -> observer.dynamics")):
            view.deliver("mass", "dynamics", mass(0), 0)
        with pytest.raises(UndeclaredReader, match=re.escape("observer.predictor.dynamics")):
            view.deliver("mass", "predictor.dynamics", mass(0), 0)

    def test_shows_nothing_of_the_faults(self) -> None:
        view = make([SCALE]).for_module("observer")
        assert {name for name in dir(view) if not name.startswith("_")} == {"module", "deliver"}
        assert not hasattr(view, "__dict__")
        assert not hasattr(view.deliver, "__self__")
        assert "Scale" not in repr(view)
        assert "factor" not in repr(view)
        for name in ("state", "receipts", "faults", "taps", "_taps", "verify"):
            with pytest.raises(AttributeError):
                getattr(view, name)
        with pytest.raises(AttributeError):
            view.module = "planner"  # pyright: ignore[reportAttributeAccessIssue]


def test_a_value_offset_by_zero_is_the_reading_itself() -> None:
    taps = make([Fault(channel="mass", intervention=Offset(by=0.0))])
    reading = mass(0)
    assert np.shares_memory(taps.deliver("mass", "observer.model", reading, 0), reading.value)
