"""Type-I errors, coverage and power by simulation at n = 100, with one and three seeds.

A population is a list of scene types (weight, p_first, p_second): the seeds of one scene share its
type, which correlates them as shared geometry does. Every rate below is compared with its target
within ``noise(rate)``, 3.3 Monte-Carlo standard errors, plus the bias stated in the test.
"""

import numpy as np
import pytest
from scipy.stats import binomtest

from faultpath.statistics import (
    Discordant,
    Resamples,
    break_even,
    detectable_by_sign_test,
    detectable_by_standard_error,
    detectable_success,
    discordant,
    mcnemar_mid_p,
    mean_effect,
    median_effect,
    reversal,
    sign_test,
    success_effect,
    success_test,
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
    rejected = [success_test(*sample(rng, population, n_seeds)).rejects() for _ in range(RUNS)]
    assert 0.01 - noise(0.01) < np.mean(rejected) <= 0.05 + noise(0.05)


def test_type_one_error_of_mid_p():
    """Mid-p is less conservative: nearer 5 % than the exact test, never far above it."""
    rng = np.random.default_rng(20)
    counts = [discordant(*sample(rng, NO_EFFECT, 1)) for _ in range(RUNS)]
    mid = np.mean([mcnemar_mid_p(c).rejects() for c in counts])
    exact = np.mean([binomtest(c.first_only, c.total).pvalue <= 0.05 for c in counts])
    assert exact < mid <= 0.05 + noise(0.05)


@pytest.mark.parametrize("n_seeds", [1, 3])
@pytest.mark.parametrize("population", [NO_EFFECT, NO_MEAN_EFFECT, LARGE_EFFECT, COST])
def test_coverage_of_the_scene_bootstrap(population, n_seeds):
    """95 % less up to 1 point: a percentile interval uses n, not n - 1."""
    true = effect_pp(population)
    intervals = [e.estimate().interval for e in effects(30 + n_seeds, population, n_seeds)]
    covered = np.mean([low <= true <= high for low, high in intervals])
    assert 0.94 - noise(0.95) <= covered <= 0.97 + noise(0.95)


@pytest.mark.parametrize("n_seeds", [1, 3])
def test_coverage_of_the_break_even_interval_and_power_of_reversal(n_seeds):
    """Cost -8 pp and gain +12 pp cross at 40 %; a percentile interval is off by at most 1 point."""
    correct, faulty = effects(40, COST, n_seeds), effects(50, GAIN, n_seeds)
    covered, reversed_ = 0, 0
    for first, second in zip(correct, faulty, strict=True):
        low, high = break_even(first, second).interval or (2.0, 2.0)
        covered += low <= 0.4 <= high
        reversed_ += reversal(first, second).detected
    assert 0.94 - noise(0.95) <= covered / RUNS <= 0.97 + noise(0.95)
    assert reversed_ / RUNS > 0.85


def test_reversal_is_rarely_claimed_where_there_is_none():
    """The signs must differ as well, so less than the interval's 5 % is claimed."""
    claims = [
        reversal(a, b).detected
        for a, b in zip(effects(60, COST, 3), effects(70, COST, 3), strict=True)
    ]
    assert 0 < np.mean(claims) <= 0.05


def test_coverage_of_the_median_interval():
    """Exponential within-scene differences, about 65 joint scenes; bias up to 2 points."""
    rng = np.random.default_rng(80)
    covered, runs = 0, 500
    for _ in range(runs):
        second = rng.random(N)
        first = second + rng.exponential(size=N)
        effect = median_effect(first, second, rng.random(N) < 0.65, RESAMPLES)
        low, high = effect.estimate().interval
        covered += low <= np.log(2) <= high
    assert 0.93 - noise(0.95, runs) <= covered / runs <= 0.97 + noise(0.95, runs)


@pytest.mark.parametrize(("n_seeds", "least"), [(3, 0.80), (10, 0.90)])
def test_coverage_over_new_seeds_needs_the_crossed_bootstrap(n_seeds, least):
    """Seeds that matter: scenes alone miss, scenes and seeds come near, few seeds fall short.

    Resampling three seeds understates their variance by a third; hence 80 % and not 95 %.
    """
    rng = np.random.default_rng(90)
    covered, runs = {True: 0, False: 0}, 500
    for _ in range(runs):
        scene, seed = rng.normal(size=(N, 1)), rng.normal(0, 0.4, size=n_seeds)
        first = 0.5 + scene + seed + rng.normal(0, 0.5, size=(N, n_seeds))
        for crossed in covered:
            effect = mean_effect(
                first, np.zeros_like(first), RESAMPLES, "m", resample_seeds=crossed
            )
            low, high = effect.estimate().interval
            covered[crossed] += low <= 0.5 <= high
    assert least - noise(least, runs) <= covered[True] / runs <= 0.97
    assert covered[False] / runs < covered[True] / runs - 0.05


@pytest.mark.parametrize(("first_only", "second_only"), [(0, 0), (2, 15), (11, 8), (51, 1)])
def test_exact_mcnemar_has_80_percent_power_at_its_detectable_difference(first_only, second_only):
    counts = Discordant(first_only=first_only, second_only=second_only, n_pairs=N)
    found = detectable_success(counts)
    rate, difference = found.discordant_rate, found.value / 100
    rng = np.random.default_rng(100)
    runs = 4000
    total = rng.binomial(N, rate, size=runs)
    favour = rng.binomial(total, 0.5 + 0.5 * difference / rate)
    splits = list(zip(np.minimum(favour, total - favour), total, strict=True))
    rejects = {(k, n): binomtest(k, n).pvalue <= 0.05 for k, n in set(splits) if n}
    rejected = [rejects.get(split, False) for split in splits]
    assert abs(np.mean(rejected) - 0.8) <= noise(0.8, runs)


@pytest.mark.parametrize("n_seeds", [1, 3])
def test_detectable_difference_by_standard_error_has_about_80_percent_power(n_seeds):
    """Of the bootstrap interval; a normal approximation, hence 6 points of allowed bias."""
    low, high = 0.0, 0.5
    while high - low > 1e-6:  # the population whose true effect is 2.80 true standard errors
        q = (low + high) / 2
        p1, p2 = 0.5 + q, 0.5 - q
        within = (p1 * (1 - p1) + p2 * (1 - p2)) / n_seeds
        mean = 0.6 * (p1 - p2)
        error = np.sqrt((0.6 * ((p1 - p2) ** 2 + within) - mean**2) / N)
        low, high = (q, high) if mean < 2.8016 * error else (low, q)
    population = [(0.4, 1.0, 1.0), (0.6, p1, p2)]
    rng = np.random.default_rng(110)
    detected, values = 0, []
    for _ in range(RUNS):
        first, second = sample(rng, population, n_seeds)
        detected += success_effect(first, second, RESAMPLES).estimate().detected_sign == 1
        values.append(detectable_by_standard_error(first, second, "pp", scale=100.0).value)
    assert abs(detected / RUNS - 0.8) <= 0.06 + noise(0.8)
    assert np.mean(values) == pytest.approx(100 * mean, rel=0.03)


def test_detectable_difference_of_the_sign_test_has_80_percent_power():
    """Scenes differ with rate 0.2, by one or by all three seeds: mean size 2/3."""
    size = np.repeat([1, 3], 10)
    first = np.zeros((N, 3))
    first[:20] = np.arange(3) < size[:, None]
    found = detectable_by_sign_test(first, np.zeros((N, 3)))
    per_scene = found.value / 100 / (2 / 3)
    rng = np.random.default_rng(120)
    rejected = 0
    for _ in range(RUNS):
        seeds = np.arange(3) < rng.choice([1, 3], size=N)[:, None]
        differs = rng.random((N, 1)) < 0.2
        wins = rng.random((N, 1)) < 0.5 + 0.5 * per_scene / 0.2
        rejected += sign_test(seeds & differs & wins, seeds & differs & ~wins).rejects()
    assert found.discordant_rate == 0.2
    assert abs(rejected / RUNS - 0.8) <= noise(0.8)
