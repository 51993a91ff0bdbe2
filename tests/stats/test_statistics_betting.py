"""Bets on the mean of scenes: fair, the same in any order, and one with their intervals."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from paired import counted

from faultpath.core.streams import generator
from faultpath.stats.betting import log_capital
from faultpath.stats.contrast import change
from faultpath.stats.decisions import decide_family, with_test
from faultpath.stats.effects import success_effect


def effect(first, second):
    return with_test(success_effect(first, second, sequential=True))


@pytest.mark.parametrize(
    ("sizes", "chances"),
    [
        ((-1.0, 0.0, 1.0), (0.2, 0.5, 0.3)),
        ((-1.0, -0.5, 0.5, 1.0), (0.1, 0.4, 0.3, 0.2)),
        ((0.0, 1.0), (0.9, 0.1)),
    ],
)
def test_a_bet_on_the_true_mean_is_fair_and_on_more_is_a_loss(sizes, chances):
    """Every sequence of five scenes, weighed with its chance."""
    mean = float(np.dot(sizes, chances))
    fair, loss = 0.0, 0.0
    for drawn in product(range(len(sizes)), repeat=5):
        chance = float(np.prod([chances[i] for i in drawn]))
        values = np.array([sizes[i] for i in drawn])
        fair += chance * np.exp(log_capital(values, np.ones(5), mean, 1.0))
        loss += chance * np.exp(log_capital(values, np.ones(5), mean + 0.1, 1.0))
    assert fair == pytest.approx(1.0)
    assert loss < 0.95


def test_a_bet_on_discordant_pairs_is_robbins_mixture():
    """Of one seed: the mean of (1 + c)^wins (1 - c)^losses over the arcsine law, by integration."""
    angle = (np.arange(20_000) + 0.5) * np.pi / 40_000
    for wins, losses in ((0, 0), (7, 0), (5, 3), (2, 9)):
        stakes = np.sin(angle)
        exact = float(((1.0 + stakes) ** wins * (1.0 - stakes) ** losses).mean())
        counts = np.array([losses, 4.0, wins])
        found = float(np.exp(log_capital(np.array([-1.0, 0.0, 1.0]), counts, 0.0, 1.0)))
        assert found == pytest.approx(exact, rel=1e-2)


@pytest.mark.parametrize("scenes", [1, 2, 4, 14])
def test_the_interval_leaves_out_0_exactly_where_the_test_rejects(scenes):
    for wins in range(scenes + 1):
        for losses in range(scenes + 1 - wins):
            found = effect(*counted(wins, losses, scenes))
            assert found.test is not None
            assert (found.sign_of_interval != 0) == (found.test.p_value <= 0.05)
            assert found.sign_of_interval in (0, found.test.leans)
            assert found.test.leans == np.sign(wins - losses)
            low, high = found.interval
            assert -100.0 <= low < high <= 100.0
            assert low <= found.value <= high


@given(st.integers(0, 2**32), st.integers(1, 3))
def test_swapping_the_variants_mirrors_and_copying_a_seed_changes_nothing(seed, seeds):
    stream = generator("betting", "mirror", seed)
    first, second = stream.random((2, 30, seeds)) < 0.5
    found, mirrored = effect(first, second), effect(second, first)
    copied = effect(np.tile(first, (1, 2)), np.tile(second, (1, 2)))
    low, high = found.interval
    assert mirrored.interval == (-high, -low)
    assert mirrored.test.p_value == found.test.p_value
    assert copied.interval == pytest.approx(found.interval, abs=1e-9)
    assert copied.test.p_value == pytest.approx(found.test.p_value)


def test_each_contrast_stands_at_its_own_share():
    one, two = effect(*counted(9, 0, 40)), effect(*counted(0, 9, 40))
    family = {"one": one, "two": two, "change": with_test(change(one, two))}
    shares = {"one": 0.5, "two": 0.1, "change": 0.1}
    decided = decide_family(family, 0.05, shares)
    for name, each in decided.items():
        p = family[name].test.p_value
        assert each.test.corrected_p == pytest.approx(min(1.0, p / shares[name]))
        assert each.test.critical_p == pytest.approx(0.05 * shares[name])
        assert each.sign == (family[name].test.leans if p <= 0.05 * shares[name] else 0)
    assert (decided["one"].sign, decided["two"].sign) == (1, 0)


def test_a_look_after_every_scene_announces_too_much_in_at_most_5_percent():
    """Fair scenes of three kinds, and a library that is even as a whole, in random order."""
    stream, kinds = generator("betting", "looks", 0), np.array([-1.0, 0.0, 1.0])
    needed = np.log(2.0 / 0.05)
    drawn = stream.choice(kinds, (1000, 120), p=[0.2, 0.6, 0.2])
    library = np.repeat(kinds, [20, 60, 20])
    ordered = stream.permuted(np.tile(library, (1000, 1)), axis=1)
    for values in (drawn, ordered):
        looks = (values[..., np.newaxis] == kinds).cumsum(axis=1)
        sides = (log_capital(kinds, counts, 0.0, 1.0) for counts in (looks, looks[..., ::-1]))
        ever = np.maximum(*sides) >= needed
        assert ever.any(axis=1).mean() < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 1000)
        assert ever.any(axis=1).mean() > 0.002
