"""The test of several seeds: every flip of signs, and the score beside it."""

import itertools

import numpy as np
import pytest
from scipy.stats import norm
from simulation import announces

from faultpath.decisions.family import CORRECT, SHARED, decide_paths
from faultpath.statistics import score, signflip
from faultpath.statistics.decisions import with_test
from faultpath.statistics.distributions import sign_p_value
from faultpath.statistics.effects import success_effect
from faultpath.statistics.power import detected
from faultpath.statistics.resamples import Resamples
from faultpath.statistics.score import reach, rejects

RULE = "unconditional"


@pytest.mark.parametrize("seed", range(6))
def test_the_p_is_that_of_every_flip(seed):
    rng = np.random.default_rng(seed)
    sums = rng.integers(-3, 4, size=10)
    signs = np.array(list(itertools.product((-1, 1), repeat=len(sums))))
    expected = (np.abs(signs @ sums) >= abs(sums.sum())).mean()
    assert signflip.p_value(sums / 3, 3) == pytest.approx(expected, abs=1e-15)
    assert signflip.p_value(sums / 12, 3) == pytest.approx(expected, abs=1e-15)  # weighted sums
    assert signflip.p_value(-sums[::-1] / 3, 3) == signflip.p_value(sums / 3, 3)
    values = np.arange(-3, 4) / 3
    counts = np.array([[(sums == size).sum() for size in range(-3, 4)]], dtype=float)
    assert signflip.p_values(values, counts)[0] == pytest.approx(expected, abs=1e-12)


def test_of_equal_sizes_it_is_the_sign_test_and_none_is_certain():
    assert signflip.p_value(np.repeat([1.0, -1.0], [14, 4]), 1) == sign_p_value(14, 4)
    assert signflip.p_value(np.zeros(5), 3) == 1.0
    assert signflip.p_value(np.ones(1000), 5) == 2.0**-999
    with pytest.raises(ValueError, match="no parts"):
        signflip.p_value(np.full(3, 0.1234567), 3)


@pytest.mark.parametrize("seed", range(4))
def test_the_scores_p_is_where_it_begins_to_reject(seed):
    rng = np.random.default_rng(seed)
    values, counts = np.unique(rng.integers(-2, 4, size=30) / 3, return_counts=True)
    counts = counts.astype(float)
    far = float(reach(values, counts, 1.0, 12.0))
    z = norm.isf(score.p_value(values, counts, far) / 2)
    assert rejects(values, counts, 0.0, far, z - 1e-6)
    assert not rejects(values, counts, 0.0, far, z + 1e-6)
    tango = score.p_value(np.array([-1.0, 0.0, 1.0]), np.array([4.0, 30.0, 14.0]), 1.0)
    assert tango == pytest.approx(2 * norm.sf((14 - 4) / np.sqrt(18)))


def lopsided(rng: np.random.Generator, scenes: int, gains: float) -> tuple[np.ndarray, np.ndarray]:
    """Return two arms of one mean: many scenes gain one of three seeds, few lose all of them."""
    kind, which = rng.random((scenes, 1)), rng.integers(0, 3, size=(scenes, 1))
    gained = (kind < gains) & (np.arange(3) == which)
    lost = (kind > 1.0 - gains / 3) & np.ones(3, dtype=bool)
    return ~lost, ~gained


@pytest.mark.parametrize("gains", [0.3, 0.6])
def test_many_small_gains_against_few_whole_losses_are_no_difference(gains):
    """The sign test, with an interval at 95 % as the only guard, announced .07 to .18."""
    rng, audits, announced = np.random.default_rng(11), 250, {"exact": 0, RULE: 0}
    paths = (CORRECT, "first", "second", SHARED)
    for _ in range(audits):
        arms = {path: lopsided(rng, 100, gains) for path in paths}
        for rule in announced:
            announced[rule] += announces(decide_paths(arms, rule=rule))
    assert announced["exact"] > 0.07 * audits
    assert announced[RULE] <= 0.046 * audits + 3 * np.sqrt(0.05 * 0.95 * audits)


@pytest.mark.parametrize("alpha", [0.05, 0.005])
def test_power_takes_the_test_that_decides(alpha):
    rng = np.random.default_rng(2)
    values = np.arange(-3, 4) / 3
    chances = [0.02, 0.03, 0.05, 0.5, 0.1, 0.1, 0.2]
    resamples = Resamples.draw("power", 40, n_resamples=1)
    for _ in range(30):
        sums = rng.choice(np.arange(-3, 4), p=chances, size=40)
        wins = np.arange(3) < np.maximum(sums, 0)[:, np.newaxis]
        losses = np.arange(3) < np.maximum(-sums, 0)[:, np.newaxis]
        found = with_test(success_effect(wins, losses, resamples, rule=RULE), RULE)
        counts = np.array([[(sums == size).sum() for size in range(-3, 4)]], dtype=float)
        far = reach(values, counts, 1.0, 12.0)
        expected = found.test.p_value <= alpha and found.side != 0
        assert detected(values, counts, far, alpha, RULE)[0] == expected
