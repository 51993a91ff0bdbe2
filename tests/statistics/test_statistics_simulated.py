"""Type-I errors, coverage and power by simulation at n = 100, with one and three seeds.

A population is a list of scene types (weight, p_first, p_second): the seeds of one scene share its
type, which correlates them as shared geometry does. Every rate below is compared with its target
within ``noise(rate)``, 3.3 Monte-Carlo standard errors, plus the bias stated in the test.
"""

import numpy as np
import pytest

from faultpath.statistics import (
    Resamples,
    break_even,
    change,
    decide_family,
    median_effect,
    success_effect,
    turn,
    with_test,
)

N, RUNS = 100, 1000
RESAMPLES = Resamples.draw("simulated", N, n_resamples=2000)
SURE = [(0.50, 1.0, 1.0), (0.25, 0.0, 0.0)]
NO_EFFECT = [*SURE, (0.25, 0.5, 0.5)]
NO_MEAN_EFFECT = [*SURE, (0.125, 0.9, 0.2), (0.125, 0.2, 0.9)]
LARGE_EFFECT = [*SURE, (0.25, 0.8, 0.3)]
COST = [(0.5, 1.0, 1.0), (0.2, 0.0, 0.0), (0.2, 0.2, 0.8), (0.1, 0.8, 0.4)]  # -8 pp
GAIN = [(0.4, 1.0, 1.0), (0.3, 0.0, 0.0), (0.3, 0.7, 0.3)]  # +12 pp


def noise(rate, runs=RUNS):
    return 3.3 * np.sqrt(rate * (1 - rate) / runs)


def sample(rng, population, n_seeds):
    weight, first, second = np.array(population).T
    kind = rng.choice(len(weight), size=N, p=weight)
    shape = (N, n_seeds)
    return rng.random(shape) < first[kind, None], rng.random(shape) < second[kind, None]


def effect_pp(population):
    return 100 * sum(weight * (first - second) for weight, first, second in population)


def effects(seed, population, n_seeds):
    rng = np.random.default_rng(seed)
    for _ in range(RUNS):
        yield success_effect(*sample(rng, population, n_seeds), RESAMPLES)


@pytest.mark.parametrize("n_seeds", [1, 3])
@pytest.mark.parametrize("population", [NO_EFFECT, NO_MEAN_EFFECT])
def test_type_one_error_of_the_exact_tests(population, n_seeds):
    """Exact tests keep below 5 %; discreteness may take them to 1 %, a broken test to 0 or 10."""
    rng = np.random.default_rng(10 + n_seeds)
    drawn = (sample(rng, population, n_seeds) for _ in range(RUNS))
    rejected = [
        with_test(success_effect(*arms, RESAMPLES), "exact").test.rejects() for arms in drawn
    ]
    assert 0.01 - noise(0.01) < np.mean(rejected) <= 0.05 + noise(0.05)


@pytest.mark.parametrize("n_seeds", [1, 3])
@pytest.mark.parametrize("population", [NO_EFFECT, NO_MEAN_EFFECT, LARGE_EFFECT, COST])
def test_coverage_of_the_score_interval(population, n_seeds):
    true = effect_pp(population)
    intervals = [e.interval for e in effects(30 + n_seeds, population, n_seeds)]
    covered = np.mean([low <= true <= high for low, high in intervals])
    assert 0.94 - noise(0.95) <= covered <= 0.97 + noise(0.95)


@pytest.mark.parametrize("n_seeds", [1, 3])
def test_coverage_of_the_break_even_set_and_power_of_reversal(n_seeds):
    """Cost -8 pp and gain +12 pp cross at 40 %; the three decisions are one family."""
    covered, reversed_ = 0, 0
    for first, second in zip(effects(40, COST, n_seeds), effects(50, GAIN, n_seeds), strict=True):
        covered += any(low <= 0.4 <= high for low, high in break_even(first, second).pieces)
        reversed_ += turned(first, second) == "reversal"
    assert 0.94 - noise(0.95) <= covered / RUNS <= 0.97 + noise(0.95)
    assert reversed_ / RUNS > {1: 0.1, 3: 0.3}[n_seeds]


def test_reversal_is_rarely_claimed_where_there_is_none():
    """Both effects are -8 pp; one of them would have to be detected on the wrong side."""
    pairs = zip(effects(60, COST, 3), effects(70, COST, 3), strict=True)
    assert sum(turned(a, b) == "reversal" for a, b in pairs) == 0


def turned(isolated, shared):
    found = {"isolated": isolated, "shared": shared, "change": change(isolated, shared)}
    return turn(
        **decide_family({name: with_test(effect, "exact") for name, effect in found.items()})
    )


def test_coverage_of_the_median_interval():
    """Exponential within-scene differences, about 65 joint scenes; bias up to 2 points."""
    rng = np.random.default_rng(80)
    covered, runs = 0, 500
    for _ in range(runs):
        second = rng.random(N)
        first = second + rng.exponential(size=N)
        effect = median_effect(first, second, rng.random(N) < 0.65, RESAMPLES)
        low, high = effect.interval
        covered += low <= np.log(2) <= high
    assert 0.93 - noise(0.95, runs) <= covered / runs <= 0.97 + noise(0.95, runs)
