"""What each intervention does, to the number, on NumPy and on torch."""

from typing import Any

import numpy as np
import pytest
from libraries import LIBRARIES

import faultpath.faults
from faultpath.core.streams import generator
from faultpath.faults import (
    Bias,
    Delay,
    Draws,
    Drift,
    Dropout,
    Erase,
    Freeze,
    Hold,
    Intervention,
    Moment,
    Noise,
    Offset,
    Quantise,
    Rotate,
    Scale,
    Sequence,
    Shuffle,
    UniformScale,
)
from faultpath.interface import Channel

SCENES = ("a", "b")
DT_S = 0.05


def play(
    intervention: Intervention, readings: list[Any], onset: int = 0, steps: list[int] | None = None
) -> list[np.ndarray[Any, Any]]:
    """Return the values, step by step, without a window around them."""
    draws = Draws(SCENES, 7, "cause")
    memory, values = None, []
    for i, reading in enumerate(readings):
        step = i if steps is None else steps[i]
        at = Moment(step, step - onset, DT_S, draws)
        if i == 0:
            memory = intervention.begin(reading, at)
        before = np.asarray(reading).copy()
        value, memory = intervention.apply(reading, memory, at)
        assert type(value) is type(reading)
        assert value.dtype == reading.dtype
        assert value.shape == reading.shape
        np.testing.assert_array_equal(np.asarray(reading), before, strict=True)
        values.append(np.asarray(value).copy())
    return values


def ramp(to: Any, steps: int = 8, shape: tuple[int, ...] = ()) -> list[Any]:
    """Return readings that tell their step and scene: scene b is 100 above scene a."""
    base = np.arange(2 * int(np.prod(shape, dtype=int)), dtype=float).reshape(2, *shape)
    return [to(base * 100 + step) for step in range(steps)]


def normals(step: int, shape: tuple[int, ...] = ()) -> np.ndarray[Any, Any]:
    return np.stack([generator("fault/cause", s, 7, step).normal(size=shape) for s in SCENES])


@LIBRARIES
@pytest.mark.parametrize(
    ("intervention", "expected"),
    [
        (Scale(factor=2.0), [[2, 4, -6], [1, 8, 10]]),
        (Scale(factor=(1.0, 0.0, 2.0)), [[1, 0, -6], [0.5, 0, 10]]),
        (Offset(by=1.0), [[2, 3, -2], [1.5, 5, 6]]),
        (Offset(by=(0.0, 0.5, 1.0)), [[1, 2.5, -2], [0.5, 4.5, 6]]),
        (Quantise(step_size=2.0), [[0, 2, -4], [0, 4, 4]]),
        (Erase(default=(0.0, 0.0, 1.0)), [[0, 0, 1], [0, 0, 1]]),
    ],
)
def test_values(to: Any, intervention: Intervention, expected: list[list[float]]) -> None:
    [value] = play(intervention, [to([[1.0, 2.0, -3.0], [0.5, 4.0, 5.0]])])
    np.testing.assert_array_equal(value, np.array(expected, dtype=value.dtype), strict=True)


def test_a_default_is_taken_from_the_channel() -> None:
    channel = Channel(
        name="wind", sources=("zero",), readers=("a.b",), erasure_default=(1.0, 2.0, 3.0)
    )
    assert Erase().resolved(channel) == Erase(default=(1.0, 2.0, 3.0))
    assert Erase(default=0.0).resolved(channel) == Erase(default=0.0)
    lost = Dropout(probability=0.5, substitute=Erase())
    nested = Sequence(parts=(lost, Scale(factor=2.0))).resolved(channel)
    assert nested.parts[0] == Dropout(probability=0.5, substitute=Erase(default=(1.0, 2.0, 3.0)))
    with pytest.raises(ValueError, match="resolve it against its channel first"):
        play(Erase(), [np.zeros(2)])


@LIBRARIES
def test_noise_is_the_keyed_stream(to: Any) -> None:
    values = play(Noise(std=(0.5, 1.0, 2.0)), ramp(to, shape=(3,)))
    for step, (value, reading) in enumerate(zip(values, ramp(np.asarray, shape=(3,)), strict=True)):
        expected = reading + np.array([0.5, 1.0, 2.0]) * normals(step, (3,))
        np.testing.assert_array_equal(value, expected)


@LIBRARIES
def test_uniform_scale_is_one_draw_a_scene(to: Any) -> None:
    values = play(UniformScale(half_range=0.2), [to(np.array([1.0, 2.0]))] * 5)
    draws = np.array([generator("fault/cause", s, 7, 0).random() for s in SCENES])
    for value in values:
        np.testing.assert_array_equal(value, np.array([1.0, 2.0]) * (1 + 0.2 * (2 * draws - 1)))


@LIBRARIES
def test_random_walk_adds_up_the_draws_since_the_onset(to: Any) -> None:
    values = play(Drift(walk_per_sqrt_s=0.3), ramp(to), onset=2)
    for step, value in enumerate(values):
        steps = [normals(s) for s in range(3, step + 1)]
        walk = 0.3 * DT_S**0.5 * np.sum(steps, axis=0) if steps else np.zeros(2)
        np.testing.assert_allclose(value, np.array([step, 100 + step]) + walk, rtol=1e-14)


@LIBRARIES
def test_random_walk_does_not_depend_on_how_often_a_tap_delivers(to: Any) -> None:
    every = play(Drift(walk_per_sqrt_s=0.3), ramp(to), 1)
    seldom = play(Drift(walk_per_sqrt_s=0.3), ramp(to)[3::4], 1, steps=[3, 7])
    np.testing.assert_array_equal(seldom, every[3::4])


@LIBRARIES
@pytest.mark.parametrize(
    ("intervention", "onset", "expected"),
    [
        (Drift(rate_per_s=4.0), 2, [0, 1, 2, 3.2, 4.4, 5.6, 6.8, 8.0]),
        (Delay(steps=0), 0, [0, 1, 2, 3, 4, 5, 6, 7]),
        (Delay(steps=3), 0, [0, 0, 0, 0, 1, 2, 3, 4]),
        (Delay(steps=20), 0, [0] * 8),
        (Hold(every=3), 1, [0, 1, 1, 1, 4, 4, 4, 7]),
        (Freeze(), 3, [0, 1, 2, 3, 3, 3, 3, 3]),
    ],
    ids=str,
)
def test_a_ramp_is_steeper_delayed_held_or_frozen(to, intervention, onset, expected) -> None:
    values = play(intervention, ramp(to), onset)
    np.testing.assert_allclose(values, np.add.outer(expected, [0, 100]), rtol=1e-15)


@LIBRARIES
@pytest.mark.parametrize("substitute", [None, Erase(default=-1.0)])
def test_dropout_loses_what_the_stream_says(to: Any, substitute: Erase | None) -> None:
    values = play(Dropout(probability=0.5, substitute=substitute), ramp(to, 30))
    last = [0.0, 100.0]
    seen = set()
    for step, value in enumerate(values):
        for i, scene in enumerate(SCENES):
            lost = generator("fault/cause", scene, 7, step).random() < 0.5
            seen.add(lost)
            if not lost:
                last[i] = 100.0 * i + step
            elif substitute is not None:
                assert value[i] == -1.0
                continue
            assert value[i] == last[i]
    assert seen == {True, False}


@LIBRARIES
@pytest.mark.parametrize("axis", [1, 2])
def test_shuffle_permutes_within_a_scene(to: Any, axis: int) -> None:
    reading = np.arange(2 * 4 * 5, dtype=float).reshape(2, 4, 5)
    values = play(Shuffle(axis=axis), [to(reading)] * 2)
    for step, value in enumerate(values):
        for i, scene in enumerate(SCENES):
            order = generator("fault/cause", scene, 7, step).permutation(reading.shape[axis])
            np.testing.assert_array_equal(value[i], np.take(reading[i], order, axis=axis - 1))
    assert not np.array_equal(values[0], values[1])


def test_parts_of_a_sequence_draw_independently() -> None:
    twice = play(Sequence(parts=(Noise(std=1.0), Noise(std=1.0))), [np.zeros(2)])[0]
    once = play(Noise(std=1.0), [np.zeros(2)])[0]
    assert not np.any(np.isclose(twice, 2 * once))


def test_memory_outlives_a_producer_that_reuses_its_array() -> None:
    draws = Draws(SCENES, 7, "cause")
    for intervention in (Delay(steps=1), Freeze(), Hold(every=9), Dropout(probability=1.0)):
        buffer = np.array([1.0, 2.0])
        at = Moment(0, 0, DT_S, draws)
        memory = intervention.begin(buffer, at)
        _, memory = intervention.apply(buffer, memory, at)
        buffer[:] = 50.0
        value, _ = intervention.apply(buffer, memory, Moment(1, 1, DT_S, draws))
        np.testing.assert_array_equal(value, [1.0, 2.0])


@pytest.mark.parametrize(
    "intervention",
    [
        Scale(factor=1.0),
        UniformScale(half_range=0.0),
        Offset(by=0.0),
        Offset(by=(0.0, 0.0, 0.0)),
        Noise(std=0.0),
        Noise(std=0.0, relative=True),
        Drift(),
        Bias(std=0.0),
        Delay(steps=0),
        Hold(every=1),
        Dropout(probability=0.0),
        Sequence(parts=(Scale(factor=1.0), Delay(steps=0))),
    ],
)
@LIBRARIES
def test_an_identity_keeps_every_bit(to: Any, intervention: Intervention) -> None:
    awkward = np.array([[-0.0, 5e-324, np.inf], [-np.inf, np.nan, 0.1]])
    for value in play(intervention, [to(awkward.copy()) for _ in range(4)], 1):
        assert value.tobytes() == awkward.tobytes()


@pytest.mark.parametrize(
    ("intervention", "shape", "misfit"),
    [
        (
            Scale(factor=(1.0, 2.0)),
            (),
            "scale has 2 numbers, and the reading of one scene has one number",
        ),
        (
            Offset(by=(1.0, 2.0)),
            (3,),
            "offset has 2 numbers, and the reading of one scene has 3 numbers",
        ),
        (Offset(by=(1.0, 2.0, 3.0)), (4, 3), None),
        (Erase(default=((1.0, 2.0),)), (1, 2), None),
        (
            Erase(default=((1.0, 2.0),)),
            (2,),
            "erase has the shape [1, 2], and the reading of one scene has 2",
        ),
        (Noise(std=(1.0, 2.0)), (3,), "noise has 2 numbers, and"),
        (Drift(rate_per_s=(1.0, 2.0)), (3,), "drift has 2 numbers, and"),
        (Bias(std=(1.0, 2.0)), (3,), "bias has 2 numbers, and"),
        (Erase(), (3,), None),
        (Erase(default=(1.0,)), (3,), "erase has 1 number, and"),
        (Dropout(probability=0.1, substitute=Erase(default=(1.0,))), (3,), "erase has 1 number"),
        (Shuffle(axis=2), (3,), "axis 2 does not exist: the reading of one scene has 1 axes"),
        (Sequence(parts=(Freeze(), Shuffle(axis=1))), (), "axis 1 does not exist"),
        (Rotate(by=(0.0, 0.0, 1.0)), (5, 3), None),
        (Rotate(by=(0.0, 0.0, 1.0)), (3, 4), "the reading of one scene has shape [3, 4], which"),
        (Delay(steps=2), (), None),
    ],
)
def test_says_why_it_does_not_fit(
    intervention: Intervention, shape: tuple[int, ...], misfit: str | None
) -> None:
    sentence = intervention.misfit(shape)
    assert sentence is misfit if misfit is None else (sentence or "").startswith(misfit)


def test_every_kind_is_a_public_name():
    kinds = {kind.__name__ for kind in faultpath.faults.INTERVENTIONS.values()}
    assert kinds <= set(faultpath.faults.__all__)
