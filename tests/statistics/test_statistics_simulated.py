"""Type-I errors, coverage and power by simulation at n = 100, with one and three seeds.

A population is a list of scene types (weight, p_first, p_second): the seeds of one scene share its
type, which correlates them as shared geometry does. Every rate below is compared with its target
within ``noise(rate)``, 3.3 Monte-Carlo standard errors, plus the bias stated in the test.
"""

import numpy as np
import pytest

from faultpath.statistics import (
    Resamples,
    median_effect,
    success_effect,
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
