"""Delivery: what a reader may read, what a reading has to be, and that nobody changes it."""

import re
from contextlib import nullcontext
from functools import partial
from typing import Any

import numpy as np
import pytest
from libraries import LIBRARIES, to_torch
from tap_toys import make

from faultpath.core.errors import UserError
from faultpath.faults import (
    Bias,
    Delay,
    Drift,
    Dropout,
    Erase,
    Fault,
    Freeze,
    Hold,
    Noise,
    Quantise,
    Scale,
    UniformScale,
)
from faultpath.loop import (
    IllegalRead,
    MalformedReading,
    NotFinite,
    Reading,
    Taps,
    UndeclaredReader,
    WrittenTo,
)

SCALE = Fault(channel="mass", intervention=Scale(factor=2.0), readers=("observer",))


def mass(step: int, value: Any = None, source: str = "scale") -> Reading:
    return Reading(np.array([1.0, 3.0]) if value is None else value, source, step)


def test_without_a_fault_the_reader_gets_the_very_tensor() -> None:
    taps = make([SCALE])
    value = to_torch([1.0, 3.0])
    assert taps.deliver("mass", "predictor.dynamics", mass(0, value), 0) is value


STILL, WIND = mass(0, source="still"), Reading(np.zeros((2, 3)), "truth", 0)
FEWER, TRUE = make(readers={"predictor.dynamics"}), make(bindings={"wind": "truth"})


@pytest.mark.parametrize(
    ("taps", "tap", "reading", "error", "sentence"),
    [
        (make(), "mass -> planner.wind", mass(0), UndeclaredReader, "does not declare this"),
        (FEWER, "mass -> observer.model", mass(0), UndeclaredReader, "this variant has no such"),
        (make(), "mass -> observer.model", STILL, IllegalRead, "'still', but the channel is bound"),
        (TRUE, "wind -> planner.wind", WIND, IllegalRead, "source 'truth' is privileged"),
        (make(), "mass -> observer.model", mass(1), IllegalRead, "which is after step 0"),
    ],
)
def test_an_illegal_read_names_the_tap(taps, tap, reading, error, sentence):
    channel, reader = tap.split(" -> ")
    with pytest.raises(error, match=f"^tap {tap}: .*{re.escape(sentence)}"):
        taps.deliver(channel, reader, reading, 0)


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
        ({"readers": {"pilot.x"}}, "this variant's readers: unknown reader 'pilot.x'"),
    ],
)
def test_wrong_names_are_a_users_mistake(given: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=re.escape(sentence)):
        make(**given)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"intervention": Quantise(step_size=0.5)}, "quantise turns int64 [2] into float64 [2]"),
        ({"intervention": UniformScale(half_range=0.2)}, "uniform_scale turns int64 [2] into frac"),
        ({"intervention": Noise(std=0.3, relative=True)}, "noise turns int64 [2] into fractions"),
        ({"intervention": Bias(std=0.3)}, "bias turns int64 [2] into fractions; choose one that "),
        ({"intervention": Drift(rate_per_s=1.0)}, "drift turns int64 [2] into fractions"),
        ({"intervention": Erase(default=0.5)}, "erase turns int64 [2] into fractions"),
        (
            {"intervention": Freeze(), "duration_steps": 1, "recovery_steps": 1},
            "freeze cannot recover step by step in int64",
        ),
    ],
)
def test_whole_numbers_are_not_turned_into_others(changes: dict[str, Any], sentence: str) -> None:
    taps = make([SCALE.model_copy(update=changes)])
    whole = np.array([1, 2])
    with pytest.raises(UserError, match=re.escape(f"fault on channel 'mass': {sentence}")):
        [taps.deliver("mass", "observer.model", mass(step, whole), step) for step in range(2)]


@pytest.mark.parametrize(
    "intervention", [Delay(steps=1), Hold(every=2), Freeze(), Dropout(probability=1.0)]
)
@pytest.mark.parametrize("later", [int, bool, np.float32])
def test_what_is_held_takes_the_type_that_the_source_has_by_then(intervention, later):
    taps = make([SCALE.model_copy(update={"intervention": intervention})])
    taps.deliver("mass", "observer.model", mass(0, np.array([1.0, 0.0])), 0)
    got = taps.deliver("mass", "observer.model", mass(1, np.array([0, 1], later)), 1)
    assert (got.tolist(), got.dtype) == ([1, 0], np.dtype(later))


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
        for name in ("state", "delivery_log", "faults", "taps", "_taps", "verify"):
            with pytest.raises(AttributeError):
                getattr(view, name)
        with pytest.raises(AttributeError):
            view.module = "planner"  # pyright: ignore[reportAttributeAccessIssue]


NULL = Fault(channel="mass", intervention=Scale(factor=1.0), readers=("observer",))
FROZEN = NULL.model_copy(update={"intervention": Freeze()})
ANY_FAULT = pytest.mark.parametrize("faults", [(), (NULL,), (SCALE,), (FROZEN,)])
CLEAN_OR_NULL = pytest.mark.parametrize("faults", [(), (NULL,)])


def deliver(taps: Taps, value: Any, step: int = 0, place: str = "observer.model") -> Any:
    return taps.deliver("mass", place, Reading(value, "scale", step), step)


@ANY_FAULT
def test_a_reader_cannot_write_into_what_it_gets(faults: tuple[Fault, ...]) -> None:
    taps = make(faults)
    plant = np.array([1.0, 3.0])
    for step in range(2):
        got = deliver(taps, plant, step)
        with pytest.raises(ValueError, match="read-only"):
            got += 1.0
        with pytest.raises(ValueError, match="read-only"):
            got[0] = 7.0
    assert plant.tolist() == [1.0, 3.0]
    plant += 1.0  # the plant's own array stays the plant's
    assert deliver(taps, plant, 2, "predictor.dynamics").tolist() == [2.0, 4.0]


@ANY_FAULT
@LIBRARIES
def test_a_second_delivery_is_the_first_one_with_a_fault_and_without(faults, to):
    taps = make(faults)
    first = deliver(taps, to([1.0, 3.0]))
    assert deliver(taps, to([1.0, 3.0])) is first
    with pytest.raises(MalformedReading, match="step 0 brings two different readings"):
        deliver(taps, to([1.0, 4.0]))
    with pytest.raises(MalformedReading, match="step 0 brings two different readings"):
        deliver(taps, to([[1.0, 3.0]]))
    assert taps.delivery_log().at("mass", "observer.model").deliveries == 1


@CLEAN_OR_NULL
@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (np.zeros(3), "the reading has 3 rows for 2 scenes: its shape is [3], and has to be [2], "),
        (np.zeros(()), "the reading has no rows for 2 scenes"),
        (
            np.zeros((2, 3)),
            "the reading of one scene has the shape [3], but source 'scale' declares `shape: []`: "
            "declare `shape: [3]` there",
        ),
        (partial(to_torch, np.zeros((2, 1))), "the reading of one scene has the shape [1]"),
        ([1.0, 2.0], "the reading's value is a list"),
        (1.0, "the reading's value is a float"),
        (None, "the reading's value is a NoneType"),
        (np.array(["a", "b"]), "the reading is of <U1; a source gives real numbers"),
        (np.array([None, 1.0]), "the reading is of object"),
        (np.array([1j, 1.0]), "the reading is of complex128"),
        (partial(to_torch, [1j, 1.0]), "the reading is of torch.complex64"),
    ],
)
def test_the_first_reading_is_as_declared_faulted_or_not(faults, value, sentence):
    with pytest.raises(MalformedReading, match=re.escape(sentence)):
        deliver(make(faults), value() if callable(value) else value)


@CLEAN_OR_NULL
@LIBRARIES
@pytest.mark.parametrize("lost", [np.nan, np.inf])
def test_the_first_reading_is_finite(faults: tuple[Fault, ...], to: Any, lost: float) -> None:
    with pytest.raises(NotFinite, match=r"in 1 of 2 scenes, 'b' for one"):
        deliver(make(faults), to([1.0, lost]))
    taps = make(faults)
    deliver(taps, to([1.0, 3.0]))
    deliver(taps, to([1.0, lost]), 1)  # only what comes first is looked at


@pytest.mark.parametrize("given", [[1.0, 2.0], 1.0, None, np.zeros(2)])
def test_what_is_no_reading_is_told_how_to_be_one(given: Any) -> None:
    with pytest.raises(MalformedReading, match=re.escape("Reading(value, 'scale', step)")):
        make().deliver("mass", "observer.model", given, 0)


@pytest.mark.parametrize("step", [-1, -2])
def test_a_step_before_the_first_is_refused(step: int) -> None:
    with pytest.raises(MalformedReading, match=f"step {step} is before the first"):
        make().deliver("mass", "observer.model", mass(step, np.zeros(2)), step)


class TestGuard:
    @pytest.mark.parametrize("inference", [False, True])
    @ANY_FAULT
    def test_a_reader_that_writes_is_named(self, inference, faults):
        import torch

        with torch.inference_mode() if inference else nullcontext():
            taps = make(faults, guard=True)
            for step in range(3):
                deliver(taps, torch.ones(2), step, "predictor.dynamics")
                got = deliver(taps, torch.ones(2), step)
                if step == 1:
                    got += 1.0
            with pytest.raises(WrittenTo, match=re.escape("tap mass -> observer.model: the read")):
                taps.verify(2)

    @pytest.mark.parametrize("inference", [False, True])
    def test_a_plant_may_write_into_its_own(self, inference: bool) -> None:
        import torch

        with torch.inference_mode() if inference else nullcontext():
            taps, plant = make(guard=True), torch.ones(2)
            for step in range(3):
                assert torch.equal(deliver(taps, plant, step), plant)
                plant += 1.0
            taps.verify(2)
