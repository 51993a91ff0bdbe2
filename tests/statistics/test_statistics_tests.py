"""Exact tests against scipy and statsmodels, and the laws that they must keep."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from statsmodels.stats.contingency_tables import mcnemar

from faultpath.statistics.decisions import with_test
from faultpath.statistics.distributions import sign_p_value
from faultpath.statistics.effects import success_effect
from faultpath.statistics.resamples import Resamples

PAIR = hnp.arrays(np.bool_, st.tuples(st.just(2), st.integers(1, 30), st.integers(1, 4)))


def test_p_values_are_the_exact_fractions_of_every_table_up_to_60_discordant_pairs():
    """Against sums of binomial coefficients in whole numbers."""
    for total in range(61):
        ways = [comb(total, k) for k in range(total + 1)]
        for first_only in range(total + 1):
            fewer = min(first_only, total - first_only)
            exact = min(Fraction(1), Fraction(2 * sum(ways[: fewer + 1]), 2**total))
            p_value = sign_p_value(first_only, total - first_only)
            assert p_value == pytest.approx(float(exact), rel=1e-12)


def found(first, second):
    """Return the tested contrast of two binary arms."""
    resamples = Resamples.draw("t", max(1, len(first)), n_resamples=1)
    return with_test(success_effect(first, second, resamples), "exact")


@settings(deadline=None)
@given(PAIR)
def test_one_seed_is_tested_by_exact_mcnemar(pair):
    one = pair[:, :, 0]
    table = [[0, int((one[0] & ~one[1]).sum())], [int((one[1] & ~one[0]).sum()), 0]]
    assert found(*one).test.name == "exact McNemar"
    assert found(*one).test.p_value == pytest.approx(mcnemar(table, exact=True).pvalue, abs=1e-12)


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (np.ones((4, 2)), np.ones((4, 3)), "one shape"),
        (np.ones((0, 2)), np.ones((0, 2)), "no outcomes"),
        (np.ones((2, 2, 2)), np.ones((2, 2, 2)), "not 3-d"),
        (np.array([1.0, np.nan]), np.ones(2), "first holds NaN"),
        (np.ones(2), np.array([1.0, np.inf]), "second holds NaN or infinity"),
        (np.ones(2), np.array([1.0, 0.5]), "second must hold only 0 and 1"),
    ],
)
def test_wrong_input_is_refused(first, second, message):
    with pytest.raises(ValueError, match=message):
        found(first, second)


@settings(deadline=None)
@given(PAIR)
def test_swapping_the_arms_swaps_the_counts_and_keeps_the_p_value(pair):
    forward, backward = found(*pair), found(*pair[::-1])
    assert backward.test.p_value == forward.test.p_value
    assert backward.test.leans == -forward.test.leans
    there = [(each.first_only, each.second_only) for each in forward.counts.per_seed]
    back = [(each.second_only, each.first_only) for each in backward.counts.per_seed]
    assert back == there


@settings(deadline=None)
@given(PAIR, st.integers(2, 4), st.randoms(use_true_random=False))
def test_copies_of_seeds_and_the_order_of_scenes_and_seeds_change_nothing(pair, times, random):
    copied = np.tile(pair, (1, 1, times))
    assert found(*copied).test.p_value == found(*pair).test.p_value
    scenes = random.sample(range(pair.shape[1]), pair.shape[1])
    seeds = random.sample(range(pair.shape[2]), pair.shape[2])
    assert found(*pair[:, scenes][:, :, seeds]).test == found(*pair).test


@settings(deadline=None)
@given(PAIR)
def test_identical_arms_have_p_one(pair):
    result = found(pair[0], pair[0])
    assert (result.test.p_value, result.test.leans) == (1.0, 0)
    assert {str(counts) for counts in result.counts.per_seed} == {"0:0"}
