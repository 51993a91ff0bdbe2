"""The score interval: Tango's for one seed, its laws for several, and never a width of zero."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from paired import conditional_effect
from scipy.optimize import brentq
from scipy.stats import binomtest, norm

from faultpath.stats.contrast import change
from faultpath.stats.effects import success_rate
from faultpath.stats.resamples import Resamples
from faultpath.stats.score import SceneValues, reach, rejects

Z = float(norm.ppf(0.975))
N = 30
RESAMPLES = Resamples.draw("score", N, n_resamples=10)
VERSIONS = hnp.arrays(np.bool_, st.tuples(st.just(2), st.just(N), st.integers(1, 4)))
laws = settings(max_examples=60, deadline=None)


def tango(first_only, second_only, n):
    """Tango's closed form (1998, equations 8 and 10), inverted with a root finder."""
    b, c = first_only, second_only

    def score(d):
        linear = -b - c + (2 * n - b + c) * d
        root = (np.sqrt(linear**2 + 8 * n * c * d * (1 - d)) - linear) / (4 * n)
        return (b - c - n * d) / np.sqrt(max(n * (2 * root + d * (1 - d)), 1e-300))

    at, edge = (b - c) / n, 1e-13
    low = -1.0 if at == -1 else brentq(lambda d: score(d) - Z, -1 + edge, at - edge, xtol=1e-14)
    high = 1.0 if at == 1 else brentq(lambda d: score(d) + Z, at + edge, 1 - edge, xtol=1e-14)
    return low, high


@pytest.mark.parametrize("n", [3, 10, 25, 100])
def test_one_seed_gives_tangos_interval(n):
    step = max(1, n // 10)
    for b in range(0, n + 1, step):
        for c in range(0, n - b + 1, step):
            values = np.concatenate([np.ones(b), -np.ones(c), np.zeros(n - b - c)])
            found = SceneValues.paired(values, 1.0, test="conditional").interval()
            assert found == pytest.approx(tango(b, c, n), abs=1e-9), (b, c)


@pytest.mark.parametrize(("n", "n_seeds"), [(100, 1), (100, 3), (25, 5)])
def test_no_discordance_has_an_interval_with_width(n, n_seeds):
    """0 of 100 used to print [0.0, 0.0]; that no scene in n differs bounds how many may."""
    none = np.zeros((n, n_seeds))
    found = conditional_effect(none, none, Resamples.draw("none", n, n_resamples=10))
    expected = 100 * Z**2 / (n + Z**2)
    assert found.value == 0.0
    assert found.interval == pytest.approx((-expected, expected))
    everything = np.concatenate([np.ones(n)])
    whole = conditional_effect(everything, 0 * everything, Resamples.draw("w", n, n_resamples=10))
    assert whole.estimate().high == 100.0
    assert whole.estimate().low == pytest.approx(100 - 2 * expected)


@laws
@given(VERSIONS, st.sampled_from([0.5, 0.95, 0.999]))
def test_the_interval_holds_exactly_the_means_that_the_test_does_not_reject(variants, level):
    values = (variants[0].astype(float) - variants[1]).mean(axis=1)
    scenes = SceneValues.paired(values, 1.0, test="conditional")
    low, high = scenes.interval(level)
    assert -1 <= low < high <= 1
    assert low <= values.mean() <= high
    nulls = np.linspace(-1, 1, 101)
    kinds, counts = np.unique(values, return_counts=True)
    often = np.broadcast_to(counts.astype(float), (len(nulls), len(counts)))
    z = float(norm.ppf(0.5 + level / 2.0))
    rejected = rejects(np.broadcast_to(kinds, often.shape), often, nulls, scenes.far, z)
    outside = (nulls < low - 1e-9) | (nulls > high + 1e-9)
    inside = (nulls > low + 1e-9) & (nulls < high - 1e-9)
    assert rejected[outside].all()
    assert not rejected[inside].any()


def test_what_was_not_seen_is_assumed_larger_than_what_was():
    size = np.array([[1.0, 3.0]])
    assert reach(size, np.array([[0.0, 0.0]]), 3.0) == 3.0
    alone = reach(size, np.array([[40.0, 0.0]]), 3.0)
    assert 1.0 < alone < 2.0
    assert reach(size, np.array([[40.0, 1.0]]), 3.0) == 3.0
    assert reach(size, np.array([[400.0, 0.0]]), 3.0) < alone


def test_a_change_is_bounded_by_the_sum_of_both_bounds():
    none = np.zeros(N)
    one = conditional_effect(none, none, RESAMPLES)
    both = change(one, one)
    assert both.scenes.far == 2.0
    assert both.interval[1] == pytest.approx(2 * one.interval[1])
    assert both.estimate().method == "score on scene differences (Tango's, cluster-robust)"


@pytest.mark.parametrize("successes", [0, 1, 15, 30])
def test_one_variants_rate_has_wilsons_interval(successes):
    outcomes = np.arange(N) < successes
    found = success_rate(outcomes, RESAMPLES)
    low, high = binomtest(successes, N).proportion_ci(method="wilson")
    assert found.interval == pytest.approx((100 * low, 100 * high), abs=1e-9)
    assert found.method == "score (Wilson)"
    seeds = success_rate(np.tile(outcomes[:, None], 3), RESAMPLES)
    assert seeds.interval == pytest.approx(found.interval)
