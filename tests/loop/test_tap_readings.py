"""What a reading has to be, and that no consumer can change it for another."""

import re
from contextlib import nullcontext
from functools import partial
from typing import Any

import numpy as np
import pytest
from libraries import LIBRARIES, to_torch
from tap_toys import make

from faultpath.faults import Fault, Freeze, Scale
from faultpath.loop import MalformedReading, NotFinite, Reading, Taps, WrittenTo

NULL = Fault(channel="mass", intervention=Scale(factor=1.0), consumers=("observer",))
STRONG = NULL.model_copy(update={"intervention": Scale(factor=2.0)})
FROZEN = NULL.model_copy(update={"intervention": Freeze()})
ANY_FAULT = pytest.mark.parametrize("faults", [(), (NULL,), (STRONG,), (FROZEN,)])
CLEAN_OR_NULL = pytest.mark.parametrize("faults", [(), (NULL,)])


def mass(step: int, value: Any) -> Reading:
    return Reading(value, "scale", step)


def deliver(taps: Taps, value: Any, step: int = 0, place: str = "observer.model") -> Any:
    return taps.deliver("mass", place, mass(step, value), step)


@ANY_FAULT
def test_a_consumer_cannot_write_into_what_it_gets(faults: tuple[Fault, ...]) -> None:
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
    assert taps.receipts().at("mass", "observer.model").deliveries == 1


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
    def test_a_consumer_that_writes_is_named(self, inference, faults):
        import torch

        with torch.inference_mode() if inference else nullcontext():
            taps = make(faults, guard=True)
            for step in range(3):
                deliver(taps, torch.ones(2), step, "predictor.dynamics")
                got = deliver(taps, torch.ones(2), step)
                if step == 1:
                    got += 1.0
            with pytest.raises(WrittenTo, match=re.escape("tap mass -> observer.model: the cons")):
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
