"""Random numbers of a fault by cause, scene, seed and step; errors that last and go together."""

from typing import Any

import numpy as np
import pytest
from libraries import LIBRARIES

from faultpath.core.streams import generator, generators
from faultpath.faults import Bias, Draws, Fault, Moment, Noise, Scale, Sequence


def test_rows_are_the_keyed_streams() -> None:
    draws = Draws(("a", "b"), 3, "storm")
    rows = zip(("a", "b"), draws.normal((2,), 5), draws.uniform((2,), 5), strict=True)
    for scene, normal, uniform in rows:
        alone = [generator("fault/storm", scene, 3, 5) for _ in range(2)]
        np.testing.assert_array_equal(normal, alone[0].normal(size=2))
        np.testing.assert_array_equal(uniform, alone[1].random(size=2))


def test_streams_of_many_scenes_are_those_of_each() -> None:
    """Whatever an earlier scene left behind: half a word, a part of a block."""
    for scene, stream in zip("abc", generators("x", "abc", 3, 5), strict=True):
        alone = generator("x", scene, 3, 5)
        assert stream.integers(9, dtype=np.uint32) == alone.integers(9, dtype=np.uint32)
        np.testing.assert_array_equal(stream.random(3), alone.random(3))


def test_parts_and_causes_and_seeds_are_apart() -> None:
    base = Draws(("a",), 0, "x")
    others = (
        base.beside("/0"),
        base.beside("/1"),
        base.beside("/0").beside("/1"),
        Draws(("a",), 1, "x"),
    )
    values = [float(draws.normal((), 0)[0]) for draws in (base, *others)]
    assert len(set(values)) == len(values)


SCENES = tuple(f"scene-{i}" for i in range(4000))
DT_S = 0.05


def biases(bias: Bias, steps: int, draws: Draws, to: Any = np.asarray) -> np.ndarray[Any, Any]:
    """Return the errors on a reading of zeros, `[T, B]`."""
    reading = to(np.zeros(len(draws.scenes)))
    memory = bias.begin(reading, Moment(0, 0, DT_S, draws))
    errors = []
    for step in range(steps):
        value, memory = bias.apply(reading, memory, Moment(step, step, DT_S, draws))
        errors.append(np.asarray(value).copy())
    return np.stack(errors)


@LIBRARIES
def test_a_bias_is_one_normal_draw_a_scene(to: Any) -> None:
    errors = biases(Bias(std=0.3), 3, Draws(SCENES, 0, "cause"), to)
    assert (errors == errors[0]).all()
    assert errors[0].std() == pytest.approx(0.3, rel=0.05)
    assert errors[0].mean() == pytest.approx(0.0, abs=0.02)


def test_a_wandering_bias_is_stationary_and_forgets_with_its_time_constant() -> None:
    errors = biases(Bias(std=0.3, time_constant_s=0.5), 21, Draws(SCENES, 0, "cause"))
    np.testing.assert_allclose(errors.std(1), 0.3, rtol=0.06)
    after = [np.corrcoef(errors[0], errors[lag])[0, 1] for lag in (1, 10, 20)]
    np.testing.assert_allclose(after, np.exp([-0.1, -1.0, -2.0]), atol=0.05)


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (0.5**0.5, 0.5**0.5), (1.0, -1.0), (0.0, 0.7)])
def test_two_faults_of_one_cause_have_the_correlation_of_their_loadings(a: float, b: float) -> None:
    mass, thrust = (
        Fault(channel=channel, intervention=Bias(std=0.1), cause="weather", loading=loading)
        for channel, loading in (("mass", a), ("thrust", b))
    )
    errors = [biases(Bias(std=0.1), 1, fault.draws(SCENES, 0))[0] for fault in (mass, thrust)]
    assert np.corrcoef(errors)[0, 1] == pytest.approx(a * b, abs=0.04)
    for error in errors:
        assert error.std() == pytest.approx(0.1, rel=0.05)


def test_a_fault_that_draws_nothing_has_no_loading() -> None:
    with pytest.raises(ValueError, match="scale takes no loading; leave it out"):
        Fault(channel="mass", intervention=Scale(factor=1.1), loading=0.5)
    still = Sequence(parts=(Scale(factor=1.1), Scale(factor=0.9)))
    with pytest.raises(ValueError, match="sequence takes no loading; leave it out"):
        Fault(channel="mass", intervention=still, loading=0.5)


def test_parts_of_a_sequence_are_correlated_each_with_its_like_and_not_with_the_others() -> None:
    parts = Sequence(parts=(Scale(factor=1.0), Bias(std=0.1), Noise(std=0.1)))
    one, two = (
        Fault(channel=channel, intervention=parts, cause="weather", loading=0.5**0.5)
        for channel in ("mass", "thrust")
    )
    draws = [fault.draws(SCENES, 0) for fault in (one, two)]
    for index in (1, 2):
        drawn = [each.beside(f"/{index}").normal((), 0) for each in draws]
        assert np.corrcoef(drawn)[0, 1] == pytest.approx(0.5, abs=0.05)
    across = [draws[0].beside("/1").normal((), 0), draws[1].beside("/2").normal((), 0)]
    assert np.corrcoef(across)[0, 1] == pytest.approx(0.0, abs=0.05)
    whole = [
        parts.apply(np.zeros(len(SCENES)), None, Moment(0, 0, DT_S, each))[0] for each in draws
    ]
    assert np.corrcoef(whole)[0, 1] == pytest.approx(0.5, abs=0.05)
