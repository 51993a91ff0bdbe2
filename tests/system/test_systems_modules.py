"""A function as a module: its arguments are what it reads."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from faultpath.core.errors import SystemMistake
from faultpath.loop import Batch, Inputs, Port
from faultpath.system import row_wise, writes


@writes("sum", past="late", before=(1.0, 2.0))
def adder(now, late, scale, memory):
    total = scale * (now + late) + (0.0 if memory is None else memory)
    return total, total


def test_arguments_are_ports_and_what_is_given_is_read_no_more():
    assert adder.reads == {Port("now", "now"), Port("scale", "scale")}
    assert adder.reads_past == {Port("late", "late")}
    half = adder.given(scale=0.5)
    assert half.ports == adder.ports - {Port("scale", "scale")}
    assert str(half) == "adder (scale 0.5)"
    delivered = {Port("now", "now"): np.ones(2), Port("late", "late"): np.ones(2)}
    inputs = Inputs("adder", 0, delivered, {})
    outputs, memory = half.step(inputs, None)
    assert list(half.step(inputs, memory)[0]["sum"]) == [2.0, 2.0]
    assert list(outputs["sum"]) == [1.0, 1.0]
    assert half.before(Batch(("a", "b", "c"), 0, 0.1))["sum"].tolist() == [[1.0, 2.0]] * 3


def test_a_value_stays_as_it_is_when_the_function_writes_into_its_memory():
    @writes("sum")
    def summed(now, memory):
        memory = np.zeros(2) if memory is None else memory
        memory += now
        return memory, memory

    inputs = Inputs("summed", 0, {Port("now", "now"): np.ones(2)}, {})
    first, memory = summed.step(inputs, None)
    second, _ = summed.step(inputs, memory)
    assert [list(first["sum"]), list(second["sum"])] == [[1.0, 1.0], [2.0, 2.0]]


def test_mistakes_are_told_in_a_sentence():
    with pytest.raises(SystemMistake, match="unknown argument 'nwo'; did you mean 'now'"):
        adder.given(nwo=1)
    with pytest.raises(SystemMistake, match=re.escape("'readings' has no name")):
        writes("sum")(lambda *readings: readings)
    forgets = writes("sum")(lambda memory: np.zeros(2))
    with pytest.raises(SystemMistake, match="returned no pair"):
        forgets.step(Inputs("forgets", 0, {}, {}), None)


def test_a_number_that_is_given_is_one_value_for_every_scene():
    running, at = np.ones(3, bool), Port("now", "now")
    double = writes("twice")(lambda now: 2 * now).given(now=1)
    (twice,) = double.step(Inputs("double", 0, {}, {}, running), None)[0].values()
    assert (twice.tolist(), twice.dtype) == ([2.0, 2.0, 2.0], np.float64)

    @writes("sum")
    def columns(now, scale):
        return now * scale[:, 0]

    start = r"test_\w+\.py, line \d+: module 'columns' fails \(TypeError: .*one number for every "
    with pytest.raises(SystemMistake, match=f"{start}scene as its scale, .* one value a scene"):
        columns.given(scale=1.0).step(Inputs("columns", 0, {at: np.ones(3)}, {}, running), None)
    with pytest.raises(TypeError):  # what fails later had a first step that went well
        columns.given(scale=1.0).step(Inputs("columns", 1, {at: np.ones(3)}, {}, running), None)


def test_a_module_with_a_number_that_writes_into_its_input_is_not_told_of_the_number():
    @writes("sum")
    def scaled(now, scale):
        now *= scale
        return now

    now = np.ones(3)
    now.flags.writeable = False
    inputs = Inputs("scaled", 0, {Port("now", "now"): now}, {}, np.ones(3, bool))
    with pytest.raises(ValueError, match=r"^output array is read-only$"):
        scaled.given(scale=1.0).step(inputs, None)


class Gain:
    """An object that takes its constants once."""

    def __init__(self, gain, offset, start=0.0):
        self.gain, self.offset, self.sum = gain, offset, start

    def update(self, now):
        self.sum += self.gain * now + self.offset
        return self.sum


def test_objects_are_made_of_the_first_reading_and_of_what_is_given():
    module = writes("sum", of=Gain)(lambda made, now: made.update(now)).given(offset=0.5)
    assert module.reads == {Port("now", "now"), Port("gain", "gain")}
    memory, sums = module.begin(Batch(("a", "b"), 0, 0.1)), []
    for step, gains in enumerate([[1.0, 2.0], [9.0, 9.0]]):
        rows = {Port("now", "now"): np.ones(2), Port("gain", "gain"): np.array(gains)}
        outputs, memory = module.step(Inputs("module", step, rows, {}), memory)
        sums.append(outputs["sum"].tolist())
    assert sums == [[1.5, 2.5], [3.0, 5.0]]
    for make in (dict, SimpleNamespace, lambda share=0.5, *more, **options: share):
        assert writes("sum", of=make)(lambda made, now: now).reads == {Port("now", "now")}


def test_rows_are_computed_one_at_a_time():
    sizes = []

    def both(rows, factor):
        sizes.append(len(rows))
        return rows * factor, rows[:, 0]

    product, first = row_wise(both)(np.arange(6.0).reshape(3, 2), 2.0)
    assert sizes == [1, 1, 1]
    assert row_wise(both)(rows=np.ones((2, 2)), factor=3.0)[1].tolist() == [1, 1]
    for wrong in ((np.ones((3, 2)), np.ones((2, 2))), (1.0, 2.0)):
        with pytest.raises(SystemMistake, match=r"got arrays of different rows \((2, 3|none)\)"):
            row_wise(both)(*wrong)
    assert product.tolist() == [[0, 2], [4, 6], [8, 10]]
    assert first.tolist() == [0, 2, 4]
