"""The random numbers of a fault depend on cause, scene, seed and step, and on nothing else."""

import numpy as np
import pytest

from faultpath.core.streams import generator, generators
from faultpath.faults import Draws


def test_rows_are_the_keyed_streams() -> None:
    drawn = Draws(("a", "b"), 3, "storm").normal((2,), 5)
    for row, scene in zip(drawn, ("a", "b"), strict=True):
        np.testing.assert_array_equal(row, generator("fault/storm", scene, 3, 5).normal(size=2))


def test_streams_of_many_scenes_are_those_of_each() -> None:
    """Whatever an earlier scene left behind: half a word, a part of a block."""
    for scene, stream in zip("abc", generators("x", "abc", 3, 5), strict=True):
        alone = generator("x", scene, 3, 5)
        assert stream.integers(9, dtype=np.uint32) == alone.integers(9, dtype=np.uint32)
        np.testing.assert_array_equal(stream.random(3), alone.random(3))


@pytest.mark.parametrize("what", ["normal", "uniform"])
def test_a_scenes_row_does_not_depend_on_its_neighbours(what: str) -> None:
    block = getattr(Draws(("a", "b", "c"), 3, "storm"), what)((4,), 1)
    alone = getattr(Draws(("c",), 3, "storm"), what)((4,), 1)
    np.testing.assert_array_equal(block[2:], alone)


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
