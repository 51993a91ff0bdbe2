"""Detected, families and reversals: interval, test and direction together."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paired import conditional_effect, holm
from scipy.stats import binomtest, ttest_1samp

from faultpath.stats.contrast import Contrast, change
from faultpath.stats.decisions import decide_family, turn, with_test
from faultpath.stats.effects import mean_effect, success_effect, success_rate
from faultpath.stats.estimate import PairedTest
from faultpath.stats.power import fewest_scenes
from faultpath.stats.resamples import Resamples

N = 40
RESAMPLES = Resamples.draw("decisions", N, n_resamples=400)


def contrast(p_value, low=1.0, high=2.0, leans=1):
    """Return a contrast with these ends of its interval and this test."""
    draws = np.repeat([low, high], 50)
    return Contrast((low + high) / 2, "pp", 9, draws=draws, test=PairedTest("t", p_value, leans))


def test_effects_and_changes_are_tested_by_the_signs_of_scenes():
    variants = np.random.default_rng(1).random((4, N, 3)) < 0.5
    one, two = (conditional_effect(*pair, RESAMPLES) for pair in (variants[:2], variants[2:]))
    first, second = (pair[0].astype(int) - pair[1] for pair in (variants[:2], variants[2:]))
    for contrasted, difference, name in (
        (one, first, "sign test on scene means"),
        (change(one, two), second - first, "sign test on scene differences"),
    ):
        test = with_test(contrasted).test
        sums = difference.sum(axis=1)
        wins, losses = int((sums > 0).sum()), int((sums < 0).sum())
        assert (test.name, test.leans) == (name, np.sign(wins - losses))
        assert test.p_value == pytest.approx(binomtest(wins, wins + losses).pvalue)


def test_interval_and_test_have_to_point_the_same_way():
    """Many small wins and few large losses: the sign test finds the first variant, the mean is
    below.

    Thirty scenes in which one seed of five wins, ten in which all of them lose.
    """
    difference = np.zeros((N, 5), int)
    difference[:30, 0] = 1
    difference[30:] = -1
    found = with_test(conditional_effect(difference > 0, difference < 0, RESAMPLES))
    assert found.test.rejects()
    assert found.test.leans == 1
    assert found.value < 0
    assert decide_family({"it": found})["it"].sign == 0
    contrary = contrast(0.0001, low=-3.0, high=-1.0, leans=1)
    assert contrary.sign_of_interval == -1
    assert decide_family({"it": contrary})["it"].sign == 0


def test_what_has_no_test_is_refused():
    metres = mean_effect(np.ones(N), np.zeros(N), RESAMPLES, "m")
    for untested in (metres, success_rate(np.ones(N), RESAMPLES)):
        with pytest.raises(ValueError, match="has no test"):
            with_test(untested)


@settings(deadline=None)
@given(st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_the_adjustment_is_holms(p_values):
    family = decide_family({str(i): contrast(p) for i, p in enumerate(p_values)})
    for each, adjusted in zip(family.values(), holm(p_values), strict=True):
        assert each.test.corrected_p == pytest.approx(adjusted)
        if abs(adjusted - 0.05) > 1e-12:
            assert (each.sign == 1) == (adjusted <= 0.05)


@settings(deadline=None)
@given(st.lists(st.floats(0, 0.2), min_size=2, max_size=6), st.data())
def test_weighted_holm_is_the_closed_test_of_weighted_bonferroni(p_values, data):
    """One is rejected where every intersection that it is in has some p within its own part."""
    number = len(p_values)
    weight = st.sampled_from([0.5, 1.0, 3.0])
    weights = data.draw(st.lists(weight, min_size=number, max_size=number))
    names = [str(i) for i in range(number)]
    family = {name: contrast(p) for name, p in zip(names, p_values, strict=True)}
    decided = decide_family(family, weights=dict(zip(names, weights, strict=True)))
    for i, name in enumerate(names):
        rejected = all(
            any(p_values[j] <= 0.05 * weights[j] / sum(weights[k] for k in inside) for j in inside)
            for size in range(number)
            for others in combinations([j for j in range(number) if j != i], size)
            for inside in [(i, *others)]
        )
        near = abs(decided[name].test.corrected_p - 0.05) < 1e-12
        assert near or (decided[name].sign == 1) == rejected
        again = family | {name: contrast(decided[name].test.critical_p * (1 - 1e-9))}
        weighed = dict(zip(names, weights, strict=True))
        assert decide_family(again, weights=weighed)[name].sign == 1
        again[name] = contrast(decided[name].test.critical_p * (1 + 1e-9))
        assert decide_family(again, weights=weighed)[name].sign == 0


def decided(sign):
    return Contrast(0.0, "pp", 9, test=PairedTest("t", 0.5, sign, sign, 0.5, 0.05))


@pytest.mark.parametrize(
    ("isolated", "shared", "change", "expected"),
    [
        (1, -1, -1, "reversal"),
        (-1, 1, 0, "reversal"),
        (0, -1, -1, "interaction"),
        (1, 0, -1, "interaction"),
        (-1, -1, -1, "interaction"),
        (0, -1, 0, "none"),
        (1, 1, 0, "none"),
        (0, 0, 0, "none"),
    ],
)
def test_a_reversal_is_two_detected_effects_of_opposite_sign(isolated, shared, change, expected):
    assert turn(*map(decided, (isolated, shared, change))) == expected


@pytest.mark.parametrize("hypotheses", [1, 2, 3, 5, 7, 16])
def test_fewest_scenes_is_where_a_unanimous_test_first_suffices(hypotheses):
    n = fewest_scenes(0.05 / hypotheses)
    assert 2 * 0.5**n <= 0.05 / hypotheses < 2 * 0.5 ** (n - 1)
    assert fewest_scenes() == 6


def test_newly_trained_models_are_tested_by_the_seeds_effects_and_by_the_scenes():
    rng = np.random.default_rng(3)
    first, second = rng.random((2, N, 4)) < [[[0.8]], [[0.4]]]
    effect = success_effect(first, second, models=True)
    found = with_test(effect)
    assert found.test.name == "t test of seeds, E+M and score of scenes"
    by_scene = with_test(success_effect(first, second)).test.p_value
    by_seed = ttest_1samp(effect.per_seed, 0).pvalue
    assert found.test.p_value == pytest.approx(max(by_scene, by_seed))
    assert found.test.leans == 1
    assert "Student's t over seeds" in found.method
    assert found.estimand.startswith("new scenes like these and models newly trained")


def test_trainings_that_agree_do_not_spare_the_scenes_their_correction():
    """With the t test alone equal versions differed in 16 % of audits of six contrasts."""
    difference = np.zeros((N, 5))
    difference[:14], difference[14:19] = 1, -1
    difference[20, 0], difference[21, 1] = 1, -1
    effect = with_test(success_effect(difference > 0, difference < 0, models=True))
    assert ttest_1samp(effect.per_seed, 0).pvalue < 1e-4
    assert 0.025 < effect.test.p_value < 0.05
    assert decide_family({"one": effect})["one"].sign == 1
    assert decide_family({"one": effect, "two": effect})["one"].sign == 0


def test_trainings_that_agree_to_the_digit_are_not_certain():
    """Two trainings with the same rate: a share of 40 scenes is known to a fortieth only."""
    difference = np.zeros((N, 2))
    difference[:10] = 1
    effect = conditional_effect(difference, 0 * difference, RESAMPLES, models=True)
    assert 0.005 < with_test(effect).test.p_value < 0.05
    none = conditional_effect(0 * difference, 0 * difference, RESAMPLES, models=True)
    assert with_test(none).test.p_value == 1.0
