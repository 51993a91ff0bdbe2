"""Streams of random numbers: an address decides all that is drawn, whoever draws and how."""

import pickle

import numpy as np
import pytest

from faultpath.core.streams import generator, generators, key


@pytest.mark.parametrize("step", [0, 1, 2**32])
def test_an_address_gives_the_numbers_of_its_philox_key(step):
    counter = np.array([0, 0, 0, step], dtype=np.uint64)
    philox = np.random.Philox(key=key("wind", "s1", 3), counter=counter)
    expected = np.random.Generator(philox).normal(size=9)
    (moved,) = (stream.normal(size=9) for stream in generators("wind", ["s1"], 3, step))
    stream = generator("wind", "s1", 3, step)
    for drawn in (pickle.loads(pickle.dumps(stream)).normal(size=9), stream.normal(size=9), moved):
        np.testing.assert_array_equal(drawn, expected)


def test_generators_that_are_spawned_follow_from_the_address_too():
    def drawn(step: int) -> list[float]:
        stream = generator("wind", "s1", 3, step)
        return [child.normal() for child in (*stream.spawn(2), *stream.spawn(1))]

    assert drawn(4) == drawn(4)
    assert len({*drawn(4), *drawn(5)}) == 6
