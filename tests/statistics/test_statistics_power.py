"""Detectable differences: exact power against brute force, and every edge says why."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import beta, binom, binomtest, norm

from faultpath.statistics import (
    Detectable,
    Discordant,
    detectable,
    detectable_by_sign_test,
    detectable_by_standard_error,
    detectable_success,
    mcnemar_power,
)
from faultpath.statistics.distributions import (
    binomial_cdf,
    binomial_pmf,
    clopper_pearson_upper,
    normal_quantile,
)


def counted(first_only, second_only, n_pairs=100):
    return Discordant(first_only=first_only, second_only=second_only, n_pairs=n_pairs)


@settings(deadline=None)
@given(st.integers(0, 120), st.integers(-2, 122), st.floats(0.01, 0.99))
def test_distributions_agree_with_scipy(n, k, p):
    assert float(binomial_cdf(k, n, p)) == pytest.approx(binom.cdf(k, n, p), abs=1e-12)
    if 0 <= k <= n:
        assert float(binomial_pmf(k, n, p)) == pytest.approx(binom.pmf(k, n, p), abs=1e-12)
        upper = beta.ppf(0.975, k + 1, n - k) if k < n else 1.0
        assert clopper_pearson_upper(k, n) == pytest.approx(upper, abs=1e-9)
    assert normal_quantile(p) == pytest.approx(norm.ppf(p))


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 14), st.floats(0.05, 1.0), st.floats(-1, 1), st.sampled_from([0.05, 0.3]))
def test_power_agrees_with_enumerating_every_table(n, rate, lean, alpha):
    difference = lean * rate
    p_first, p_second = (rate + difference) / 2, (rate - difference) / 2
    expected = sum(
        binom.pmf(first + second, n, rate)
        * binom.pmf(first, first + second, p_first / (p_first + p_second))
        for first in range(n + 1)
        for second in range(n + 1 - first)
        if first + second and binomtest(first, first + second).pvalue <= alpha
    )
    assert mcnemar_power(n, rate, difference, alpha) == pytest.approx(expected, abs=1e-10)


@settings(deadline=None)
@given(st.integers(6, 200), st.floats(0, 1))
def test_the_test_never_exceeds_its_level(n, rate):
    assert mcnemar_power(n, rate, 0.0) <= 0.05


@settings(deadline=None)
@given(st.integers(0, 50), st.integers(0, 50))
def test_power_is_80_percent_at_the_detectable_difference_and_less_just_below(first, second):
    found = detectable_success(counted(first, second))
    difference, rate = found.value / 100, found.discordant_rate
    assert mcnemar_power(100, rate, difference) == pytest.approx(0.8, abs=1e-3)
    below = difference - 0.005
    observed = (first + second) / 100
    assert mcnemar_power(100, max(observed, below), below) < 0.8
    assert detectable_success(counted(second, first)).value == found.value


def test_more_scenes_detect_less_and_more_discordance_hides_more():
    assert detectable_success(counted(4, 30, 200)).value < detectable_success(counted(2, 15)).value
    assert detectable_success(counted(20, 20)).value > detectable_success(counted(8, 9)).value


def test_without_discordant_pairs_an_upper_bound_stands_in():
    found = detectable_success(counted(0, 0))
    assert "at most 3.6 % (Clopper-Pearson)" in found.note
    # Fewer than six discordants never reject, so at least six of 100 must be expected.
    assert found.value > 6
    # Twelve scenes: the bound, 26 %, is still below what one-sided discordance needs.
    assert detectable_success(counted(0, 0, 12)).value > 26


def test_too_few_scenes_give_a_reason():
    found = detectable_success(counted(1, 1, 5))
    assert found.value is None
    assert found.reason == (
        "with 5 scenes exact McNemar cannot reject at 0.05 with power 0.8, whatever the difference"
    )
    assert detectable_success(counted(1, 1, 6)).value is not None


def test_standard_error_version_is_2_80_standard_errors():
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(2, 50, 3))
    found = detectable_by_standard_error(first, second, "m")
    error = (first - second).mean(axis=1).std(ddof=1) / np.sqrt(50)
    assert found.value == pytest.approx(2.8016 * error, rel=1e-4)
    assert found.method == "normal approximation, 2.80 x standard error of scene means"
    assert (found.unit, found.n_seeds) == ("m", 3)
    copied = detectable_by_standard_error(np.tile(first, 2), np.tile(second, 2), "m")
    assert copied.value == pytest.approx(found.value)


@pytest.mark.parametrize("n_scenes", [1, 10])
def test_standard_error_version_says_why_there_is_none(n_scenes):
    same = np.ones((n_scenes, 3))
    found = detectable_by_standard_error(same, 0 * same, "m")
    assert (found.value, "do not vary" in found.reason) == (None, True)


def test_several_seeds_fall_back_to_the_sign_test_where_few_scenes_differ():
    first, second = np.zeros((2, 100, 3))
    assert detectable(first, second).value == detectable_success(counted(0, 0)).value
    first[:9, 0] = 1
    few = detectable(first, second)
    assert few == detectable_by_sign_test(first, second)
    assert few.value == pytest.approx(detectable_success(counted(9, 0)).value / 3)
    assert few.note.startswith("a differing scene differs by 33 pp on average")
    first[:10, 0] = 1
    assert detectable(first, second).method.startswith("normal approximation")
    assert detectable(first[:, :1], second[:, :1]) == detectable_success(counted(10, 0))


def test_wrong_input_is_refused():
    with pytest.raises(ValueError, match="needs n_pairs"):
        detectable_success(Discordant(first_only=1, second_only=2))
    with pytest.raises(ValueError, match="need 0 <="):
        mcnemar_power(100, 0.1, 0.2)
    with pytest.raises(ValueError, match="only 0 and 1"):
        detectable(np.full((4, 2), 0.5), np.ones((4, 2)))
    with pytest.raises(ValueError, match="either a value or a reason"):
        Detectable(alpha=0.05, power=0.8, method="m", n_scenes=3)
