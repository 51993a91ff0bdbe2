"""The test of scenes that differ by degrees: more seeds find more, and no skew makes a finding."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from simulation import Population, kept, skewed

from faultpath.statistics import score, unconditional
from faultpath.statistics.contrast import change
from faultpath.statistics.decisions import with_test
from faultpath.statistics.effects import success_effect
from faultpath.statistics.estimate import RULE
from faultpath.statistics.power import detected, rule_power
from faultpath.statistics.resamples import Resamples
from faultpath.statistics.score import reach

N = 40
RESAMPLES = Resamples.draw("degrees", N, n_resamples=1)
ARMS = hnp.arrays(np.bool_, st.tuples(st.just(2), st.just(N), st.integers(1, 5)))
laws = settings(max_examples=80, deadline=None)


def found(first, second):
    return with_test(success_effect(first, second, RESAMPLES, rule=RULE), RULE)


def power(scenes, population, runs=6000):
    counts = np.random.default_rng(1).multinomial(scenes, population.chances(), size=runs) * 1.0
    far = reach(population.sizes, counts, 1.0, 12.0)
    return detected(population.sizes, counts, far, 0.05, RULE).mean()


def test_three_seeds_of_which_half_of_the_scenes_agree_find_most_of_what_can_be_found():
    """Sign flips alone .70, E+M without a guard .77; the larger p of flips and score had .59."""
    assert power(100, Population(0.06, 0.8, 3, 0.5)) > 0.68


@pytest.mark.parametrize("alike", [0.5, 0.9, 0.97, 0.99])
@pytest.mark.parametrize(("scenes", "rate", "lean"), [(100, 0.1, 0.6), (50, 0.1, 1.0)])
def test_more_seeds_lose_no_power(scenes, rate, lean, alike):
    """Three nearly equal seeds found .38 where the first alone finds .47."""
    alone = rule_power(scenes, rate, rate * lean, rule=RULE)
    assert power(scenes, Population(rate, lean, 3, alike)) > alone - 0.02


def test_in_skewed_populations_the_level_is_kept():
    largest, _ = skewed(60)
    assert kept(largest, 40_000, most=0.05)


@laws
@given(ARMS)
def test_interval_and_test_agree_and_swapped_arms_mirror_them_to_the_bit(arms):
    forward, backward = found(*arms), found(*arms[::-1])
    low, high = forward.interval
    assert backward.interval == (-high, -low)
    assert backward.test.p_value == forward.test.p_value
    assert backward.test.leans == -forward.test.leans
    assert forward.test.rejects() == (forward.side != 0)
    assert low <= forward.value <= high


@laws
@given(st.integers(0, 20), st.integers(0, 20), st.integers(2, 4))
def test_of_scenes_that_differ_wholly_it_is_e_plus_m(first, second, seeds):
    scene = np.arange(N)[:, None] + np.zeros(seeds)
    arms = scene < first, (scene >= first) & (scene < first + second)
    alone = unconditional.p_value(first, second, N)
    values, counts = found(*arms).scenes.kinds()
    tango = score.p_value(values, counts, 1.0) if first != second else 1.0
    assert found(*arms).test.p_value == pytest.approx(max(alone, tango), rel=1e-9)


@laws
@given(ARMS, ARMS)
def test_power_and_changes_take_the_same_test(one, two):
    seeds = min(one.shape[2], two.shape[2])
    arms = (one[..., :seeds], two[..., :seeds])
    pair = [success_effect(*pair, RESAMPLES, rule=RULE) for pair in arms]
    moved = with_test(change(*pair), RULE)
    assert moved.test.rejects() == (moved.side != 0)
    values = np.arange(-2 * seeds, 2 * seeds + 1) / seeds
    counts = np.array([[np.isclose(moved.scenes.values, each).sum() for each in values]]) * 1.0
    rejected = score.degrees_rejects(values, counts, moved.scenes.bound, 0.05)[0]
    assert rejected == moved.test.rejects()
