"""Tests of one seed and of several against their definitions, and the laws that they keep."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.stats import norm
from simulation import Population, kept
from simulation_skewed import skewed

from faultpath.stats import score, unconditional
from faultpath.stats.contrast import change
from faultpath.stats.decisions import with_test
from faultpath.stats.distributions import sign_p_value
from faultpath.stats.effects import success_effect
from faultpath.stats.power import rule_power, significant
from faultpath.stats.score import reach, rejects

PAIR = hnp.arrays(np.bool_, st.tuples(st.just(2), st.integers(1, 30), st.integers(1, 4)))
N = 40
VARIANTS = hnp.arrays(np.bool_, st.tuples(st.just(2), st.just(N), st.integers(1, 5)))
laws = settings(max_examples=80, deadline=None)


def test_p_values_are_the_exact_fractions_of_every_table_up_to_60_discordant_pairs():
    """Against sums of binomial coefficients in whole numbers."""
    for total in range(61):
        ways = [comb(total, k) for k in range(total + 1)]
        for first_only in range(total + 1):
            fewer = min(first_only, total - first_only)
            exact = min(Fraction(1), Fraction(2 * sum(ways[: fewer + 1]), 2**total))
            p_value = sign_p_value(first_only, total - first_only)
            assert p_value == pytest.approx(float(exact), rel=1e-12)


def found(first, second, test="unconditional"):
    """Return the tested contrast of two binary variants."""
    return with_test(success_effect(first, second, test=test))


@settings(deadline=None)
@given(PAIR)
def test_one_seed_is_tested_by_exact_mcnemar(pair):
    first, second = pair[:, :, 0]
    test = found(first, second, "conditional").test
    counts = int((first & ~second).sum()), int((second & ~first).sum())
    assert (test.name, test.p_value) == ("exact McNemar", sign_p_value(*counts))


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (np.ones((4, 2)), np.ones((4, 3)), "one shape"),
        (np.ones((0, 2)), np.ones((0, 2)), "no outcomes"),
        (np.ones((2, 2, 2)), np.ones((2, 2, 2)), "not 3-d"),
        (np.ones(2), np.array([1.0, np.inf]), "second must hold only 0 and 1"),
        (np.array([np.nan, 1.0]), np.array([1.0, np.nan]), "no pair has both outcomes"),
        (np.ones(2), np.array([1.0, 0.5]), "second must hold only 0 and 1"),
    ],
)
def test_wrong_input_is_refused(first, second, message):
    with pytest.raises(ValueError, match=message):
        found(first, second)


@pytest.mark.parametrize("test", ["conditional", "unconditional"])
@settings(max_examples=60, deadline=None)
@given(PAIR, st.integers(2, 4), st.randoms(use_true_random=False))
def test_swapped_variants_mirror_to_the_bit_and_copies_and_orders_change_nothing(
    test, pair, times, random
):
    once, mirrored, same = (found(*variants, test) for variants in (pair, pair[::-1], pair[[0, 0]]))
    low, high = once.interval
    assert (mirrored.value, mirrored.interval) == (-once.value, (-high, -low))
    assert (mirrored.test.p_value, mirrored.test.leans) == (once.test.p_value, -once.test.leans)
    assert [(lost, won) for won, lost in mirrored.won] == [*once.won]
    assert (same.test.p_value, same.test.leans) == (1.0, 0)

    copied = found(*np.tile(pair, (1, 1, times)), test)
    assert (copied.value, copied.interval) == (once.value, once.interval)
    assert copied.test.p_value == once.test.p_value
    scenes, seeds = (random.sample(range(size), size) for size in pair.shape[1:])
    moved = found(*pair[:, scenes][:, :, seeds], test)
    assert (moved.test, moved.interval) == (once.test, once.interval)


@pytest.mark.parametrize("seed", range(4))
def test_the_scores_p_is_where_it_begins_to_reject(seed):
    rng = np.random.default_rng(seed)
    values, counts = np.unique(rng.integers(-2, 4, size=30) / 3, return_counts=True)
    counts = counts.astype(float)
    far = float(reach(values, counts, 1.0))
    z = norm.isf(score.p_value(values, counts, far) / 2)
    assert rejects(values, counts, 0.0, far, z - 1e-6)
    assert not rejects(values, counts, 0.0, far, z + 1e-6)
    tango = score.p_value(np.array([-1.0, 0.0, 1.0]), np.array([4.0, 30.0, 14.0]), 1.0)
    assert tango == pytest.approx(2 * norm.sf((14 - 4) / np.sqrt(18)))


@pytest.mark.parametrize("alpha", [0.05, 0.005])
def test_power_takes_the_test_that_decides(alpha):
    rng = np.random.default_rng(2)
    values = np.arange(-3, 4) / 3
    chances = [0.02, 0.03, 0.05, 0.5, 0.1, 0.1, 0.2]
    for _ in range(30):
        sums = rng.choice(np.arange(-3, 4), p=chances, size=40)
        wins = np.arange(3) < np.maximum(sums, 0)[:, np.newaxis]
        losses = np.arange(3) < np.maximum(-sums, 0)[:, np.newaxis]
        effect = found(wins, losses)
        counts = np.array([[(sums == size).sum() for size in range(-3, 4)]], dtype=float)
        expected = effect.test.p_value <= alpha and effect.sign_of_interval != 0
        assert significant(values, counts, alpha)[0] == expected


def power(scenes, population, runs=6000):
    counts = np.random.default_rng(1).multinomial(scenes, population.chances(), size=runs) * 1.0
    return significant(population.sizes, counts, 0.05).mean()


@pytest.mark.parametrize("alike", [0.5, 0.97, 0.99])
@pytest.mark.parametrize(("scenes", "rate", "lean"), [(100, 0.1, 0.6), (50, 0.1, 1.0)])
def test_more_seeds_lose_no_power(scenes, rate, lean, alike):
    """Three nearly equal seeds found .38 where the first alone finds .47."""
    alone = rule_power(scenes, rate, rate * lean)
    assert power(scenes, Population(rate, lean, 3, alike)) > alone - 0.03


def test_in_skewed_populations_the_level_is_kept():
    either, one_side, *_ = skewed(60)
    assert kept(either, 40_000, most=0.05)
    assert kept(one_side, 40_000, most=0.025)


@laws
@given(VARIANTS)
def test_interval_and_test_agree(variants):
    effect = found(*variants)
    low, high = effect.interval
    assert effect.test.rejects() == (effect.sign_of_interval != 0)
    assert low <= effect.value <= high


@laws
@given(st.integers(0, 20), st.integers(0, 20), st.integers(2, 4))
def test_of_scenes_that_differ_wholly_it_is_e_plus_m(first, second, seeds):
    scene = np.arange(N)[:, None] + np.zeros(seeds)
    variants = scene < first, (scene >= first) & (scene < first + second)
    alone = unconditional.p_value(first, second, N)
    values, counts = found(*variants).scenes.kinds
    tango = score.p_value(values, counts, 1.0) if first != second else 1.0
    assert found(*variants).test.p_value == pytest.approx(max(alone, tango), rel=1e-9)


@laws
@given(VARIANTS, VARIANTS)
def test_power_and_changes_take_the_same_test(one, two):
    seeds = min(one.shape[2], two.shape[2])
    variants = (one[..., :seeds], two[..., :seeds])
    pair = [success_effect(*pair) for pair in variants]
    moved = with_test(change(*pair))
    assert moved.test.rejects() == (moved.sign_of_interval != 0)
    values = np.arange(-2 * seeds, 2 * seeds + 1) / seeds
    counts = np.array([[np.isclose(moved.scenes.values, each).sum() for each in values]]) * 1.0
    rejected = score.degrees_rejects(values, counts, moved.scenes.bound, 0.05)[0]
    assert rejected == moved.test.rejects()
