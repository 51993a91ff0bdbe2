"""Exact tests against scipy and statsmodels, and the laws that they must keep."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.stats import binom, binomtest, spearmanr
from statsmodels.stats.contingency_tables import mcnemar

from faultpath.statistics import (
    Discordant,
    discordant,
    discordant_by_seed,
    mcnemar_exact,
    mcnemar_mid_p,
    sign_counts,
    sign_test,
    spearman,
    success_test,
)

COUNT = st.integers(0, 60)
PAIR = hnp.arrays(np.bool_, st.tuples(st.just(2), st.integers(1, 30), st.integers(1, 4)))


@settings(deadline=None)
@given(COUNT, COUNT)
def test_exact_mcnemar_agrees_with_statsmodels_and_scipy(first_only, second_only):
    ours = mcnemar_exact(Discordant(first_only=first_only, second_only=second_only)).p_value
    table = [[10, first_only], [second_only, 5]]
    assert ours == pytest.approx(mcnemar(table, exact=True).pvalue, abs=1e-12)
    if first_only + second_only:
        assert ours == pytest.approx(
            binomtest(first_only, first_only + second_only).pvalue, abs=1e-12
        )
    else:
        assert ours == 1.0


def test_both_p_values_are_the_exact_fractions_of_every_table_up_to_60_discordant_pairs():
    """1,891 tables, each against sums of binomial coefficients in whole numbers."""
    tables = 0
    for total in range(61):
        ways = [comb(total, k) for k in range(total + 1)]
        for first_only in range(total + 1):
            fewer = min(first_only, total - first_only)
            tail, at = sum(ways[: fewer + 1]), ways[fewer]
            exact = min(Fraction(1), Fraction(2 * tail, 2**total))
            mid = min(Fraction(1), Fraction(2 * tail - at, 2**total))
            counts = Discordant(first_only=first_only, second_only=total - first_only)
            assert mcnemar_exact(counts).p_value == pytest.approx(float(exact), rel=1e-12)
            assert mcnemar_mid_p(counts).p_value == pytest.approx(float(mid), rel=1e-12)
            tables += 1
    assert tables == 1891


@settings(deadline=None)
@given(COUNT, COUNT)
def test_mid_p_takes_half_of_the_observed_weight_off_each_side(first_only, second_only):
    counts = Discordant(first_only=first_only, second_only=second_only)
    exact, mid = mcnemar_exact(counts).p_value, mcnemar_mid_p(counts).p_value
    if first_only == second_only:
        assert mid == pytest.approx(1.0)
    else:
        assert mid == pytest.approx(exact - binom.pmf(first_only, counts.total, 0.5), abs=1e-12)
        assert mid < exact


def test_mid_p_known_value():
    # 2 * P(X < 1) + P(X = 1) for 1 of 6 at even odds: (2 * 1 + 6) / 64
    assert mcnemar_mid_p(Discordant(first_only=1, second_only=5)).p_value == pytest.approx(8 / 64)


@settings(deadline=None)
@given(PAIR)
def test_swapping_the_arms_swaps_the_counts_and_keeps_the_p_value(pair):
    forward, backward = sign_test(*pair), sign_test(*pair[::-1])
    assert backward.counts == forward.counts.swapped()
    assert backward.p_value == forward.p_value
    assert discordant_by_seed(*pair[::-1]) == discordant_by_seed(*pair).swapped()


@settings(deadline=None)
@given(PAIR, st.randoms(use_true_random=False))
def test_the_order_of_scenes_and_of_seeds_does_not_matter(pair, random):
    scenes = random.sample(range(pair.shape[1]), pair.shape[1])
    seeds = random.sample(range(pair.shape[2]), pair.shape[2])
    assert sign_test(*pair[:, scenes][:, :, seeds]) == sign_test(*pair)


@settings(deadline=None)
@given(PAIR, st.integers(2, 4))
def test_duplicating_seeds_does_not_shrink_the_p_value(pair, times):
    copied = np.tile(pair, (1, 1, times))
    assert sign_test(*copied).p_value == sign_test(*pair).p_value


@settings(deadline=None)
@given(PAIR)
def test_one_seed_makes_the_sign_test_the_exact_mcnemar_test(pair):
    one = pair[:, :, 0]
    assert sign_test(*one).p_value == mcnemar_exact(discordant(*one)).p_value
    assert success_test(*one).name == "exact McNemar"


@settings(deadline=None)
@given(PAIR)
def test_identical_arms_have_p_one(pair):
    result = success_test(pair[0], pair[0])
    assert (result.p_value, result.counts.total) == (1.0, 0)


def test_scene_means_decide_and_ties_drop():
    first = np.array([[1, 1, 0], [1, 0, 0], [0, 0, 0], [1, 1, 1]])
    second = np.array([[0, 0, 1], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    counts = sign_counts(first, second)  # +, tie, -, tie
    assert counts == Discordant(first_only=1, second_only=1, n_pairs=4)
    assert sign_test(first, second).n_seeds == 3


def test_rounding_does_not_break_a_tie():
    counts = sign_counts(np.array([[0.1, 0.2, 0.0]]), np.array([[0.0, 0.0, 0.3]]))
    assert (counts.first_only, counts.second_only) == (0, 0)


def test_several_seeds_are_not_pooled_into_mcnemar():
    with pytest.raises(ValueError, match="needs one seed, got 3"):
        discordant(np.ones((5, 3)), np.zeros((5, 3)))


def test_counts_say_what_they_hold():
    counts = Discordant(first_only=2, second_only=15, n_pairs=100)
    assert (str(counts), counts.total) == ("2:15", 17)
    with pytest.raises(ValueError, match="17 discordant pairs cannot come from 16"):
        Discordant(first_only=2, second_only=15, n_pairs=16)


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
        success_test(first, second)


@settings(deadline=None)
@given(hnp.arrays(np.int64, st.tuples(st.just(2), st.integers(2, 25)), elements=st.integers(0, 6)))
def test_spearman_agrees_with_scipy(pair):
    result = spearman(*pair)
    if np.ptp(pair[0]) == 0 or np.ptp(pair[1]) == 0:
        assert (result.value, "constant" in result.note) == (None, True)
    else:
        assert result.value == pytest.approx(spearmanr(*pair).statistic, abs=1e-12)
        assert (result.note is None) == (pair.shape[1] >= 20)


def test_spearman_refuses_unpaired_input():
    with pytest.raises(ValueError, match=r"two \[n\] arrays"):
        spearman(np.ones(3), np.ones(4))
