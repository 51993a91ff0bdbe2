"""Detectable differences: exact power against brute force, and its edges."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paired import counted
from scipy.stats import beta, binom, binomtest, norm

from faultpath.stats.decisions import with_test
from faultpath.stats.distributions import binomial_cdf, binomial_pmf, normal_quantile
from faultpath.stats.effects import success_effect
from faultpath.stats.power import detectable, rule_power


def differences(first, second):
    return first.astype(float) - second


def found(counts, **how):
    return detectable(differences(*counted(*counts)), test="conditional", **how)


@settings(deadline=None)
@given(st.integers(0, 120), st.integers(-2, 122), st.floats(0.01, 0.99))
def test_distributions_agree_with_scipy(n, k, p):
    assert float(binomial_cdf(k, n, p)) == pytest.approx(binom.cdf(k, n, p), abs=1e-12)
    if 0 <= k <= n:
        assert float(binomial_pmf(k, n, p)) == pytest.approx(binom.pmf(k, n, p), abs=1e-12)
    assert normal_quantile(p) == pytest.approx(norm.ppf(p))


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 11), st.floats(0.05, 1.0), st.floats(-1, 1), st.sampled_from([0.05, 0.3]))
def test_power_agrees_with_enumerating_every_table(n, rate, lean, alpha):
    """Both have to find it: the exact test, and the 95 % interval on the same side."""
    difference = lean * rate
    p_first, p_second = (rate + difference) / 2, (rate - difference) / 2
    expected = 0.0
    for first in range(n + 1):
        for second in range(n + 1 - first):
            both = with_test(success_effect(*counted(first, second, n), test="conditional"))
            if (
                both.test.leans
                and both.test.leans == both.sign_of_interval
                and both.test.rejects(alpha)
            ):
                assert binomtest(first, first + second).pvalue <= alpha
                expected += binom.pmf(first + second, n, rate) * binom.pmf(
                    first, first + second, p_first / (p_first + p_second)
                )
    found = rule_power(n, rate, difference, alpha, test="conditional")
    assert found == pytest.approx(expected, abs=1e-10)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 50), st.integers(0, 50), st.sampled_from([0.05, 0.05 / 7]))
def test_power_is_80_percent_at_the_detectable_difference_and_less_below(first, second, alpha):
    least = found((first, second), alpha=alpha)
    difference, observed = least / 100, (first + second) / 100
    assumed = observed or beta.ppf(0.975, 1, 100)
    power = rule_power(100, max(assumed, difference), difference, alpha, test="conditional")
    assert power == pytest.approx(0.8, abs=2e-3)
    below = difference - 0.005
    assert rule_power(100, max(assumed, below), below, alpha, test="conditional") < 0.8
    assert found((second, first), alpha=alpha) == least


@pytest.mark.parametrize("n_seeds", [1, 3])
def test_copying_a_seed_does_not_shrink_it(n_seeds):
    rng = np.random.default_rng(0)
    first, second = rng.random((2, 60, n_seeds)) < [[[0.6]], [[0.5]]]
    once = detectable(differences(first, second), test="conditional")
    copied = detectable(np.tile(differences(first, second), 3), test="conditional")
    assert copied == once


@pytest.mark.parametrize("test", ["conditional", "unconditional"])
@pytest.mark.parametrize(("wins", "losses"), [(5, 5), (10, 10)])
def test_the_number_to_plan_by_is_found_in_four_audits_of_five(test, wins, losses):
    """Wins on top of noise: at the other number it is .8 only if the noise gives way to them."""
    pairs = differences(*counted(wins, losses))
    seen = detectable(pairs, test=test) / 100.0
    planned = detectable(pairs, test=test, on_top=True) / 100.0
    assert 1.1 < planned / seen < 1.8
    stream, noise = np.random.default_rng(5), (wins + losses) / 100.0

    @cache
    def detects(first, second):
        effect = with_test(success_effect(*counted(first, second), test=test))
        return effect.test.rejects() and effect.test.leans == effect.sign_of_interval != 0

    def power(difference):
        chances = [noise / 2 + difference, noise / 2, 1 - noise - difference]
        drawn = stream.multinomial(100, chances, size=300)[:, :2].tolist()
        return np.mean([detects(*counts) for counts in drawn])

    assert power(planned) == pytest.approx(0.8, abs=0.07)
    assert power(seen) < power(planned)
