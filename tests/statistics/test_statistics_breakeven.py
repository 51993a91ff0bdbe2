"""Break-even frequencies: the formula, its edges, and resamples that do not cross."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from faultpath.statistics import (
    BreakEven,
    Resamples,
    break_even,
    break_even_point,
    success_effect,
)

N = 40
RESAMPLES = Resamples.draw("break-even", N, n_resamples=2000)
DELTA = st.floats(-100, 100).filter(lambda delta: delta == 0 or abs(delta) > 1e-3)


def effect(wins, losses, first_scene=0):
    """An effect in which the named number of scenes is won and lost, from ``first_scene`` on."""
    scene = (np.arange(N) - first_scene) % N
    return success_effect(scene < wins, (scene >= wins) & (scene < wins + losses), RESAMPLES)


@pytest.mark.parametrize(
    ("delta_0", "delta_f", "expected"),
    [
        (-10.0, 30.0, (0.25, "above")),
        (10.0, -30.0, (0.25, "below")),
        (1.0, 2.0, (0.0, "always")),
        (0.0, 2.0, (0.0, "always")),
        (1.0, 0.0, (0.0, "always")),
        (0.0, 0.0, (0.0, "always")),
        (-1.0, -2.0, (None, "never")),
        (0.0, -2.0, (None, "never")),
        (-1.0, 0.0, (None, "never")),
    ],
)
def test_every_combination_of_signs(delta_0, delta_f, expected):
    assert break_even_point(delta_0, delta_f) == expected


@settings(deadline=None)
@given(DELTA, DELTA, st.floats(0, 1))
def test_the_mixture_is_positive_exactly_on_the_favoured_side(delta_0, delta_f, p):
    p_star, direction = break_even_point(delta_0, delta_f)
    mixture = (1 - p) * delta_0 + p * delta_f
    if direction in ("always", "never"):
        assert mixture >= 0 if direction == "always" else mixture <= 0
    else:
        assume(abs(p - p_star) > 1e-9)
        assert (mixture > 0) == (p > p_star if direction == "above" else p < p_star)


@settings(deadline=None)
@given(DELTA, DELTA)
def test_swapping_the_arms_favours_the_other_side_of_the_same_frequency(delta_0, delta_f):
    p_star, direction = break_even_point(delta_0, delta_f)
    assume(direction in ("above", "below"))
    other = "below" if direction == "above" else "above"
    assert break_even_point(-delta_0, -delta_f) == (p_star, other)


def test_a_clear_crossing():
    result = break_even(effect(2, 10), effect(20, 2))
    assert result.p_star == pytest.approx(8 / 26)
    assert result.words == "favoured above 31 % fault frequency"
    assert 0 < result.low < result.p_star < result.high < 1
    assert result.shares.above > 0.95
    assert result.share_without_crossing == result.shares.always + result.shares.never


def test_the_interval_is_joint_on_the_same_resamples():
    """Where fault gain and nominal cost fall on the same scenes, p* hardly varies."""
    result = break_even(effect(0, 10), effect(10, 0))
    assert (result.p_star, result.interval) == (0.5, (0.5, 0.5))
    apart = break_even(effect(0, 10), effect(10, 0, first_scene=20))
    assert apart.high - apart.low > 0.2


def test_favoured_below_mirrors_favoured_above():
    above = break_even(effect(2, 10), effect(20, 2))
    below = break_even(effect(10, 2), effect(2, 20))
    # Mirrored arms: wins and losses sit on other scenes, so only the point is the same.
    assert (below.p_star, below.direction) == (above.p_star, "below")
    assert below.words == "favoured below 31 % fault frequency"
    assert 0 < below.low < below.p_star < below.high < 1


def test_resamples_without_crossing_count_as_the_nearer_end():
    """Cost of one scene: about 37 % of the resamples miss it and are favoured always, p* = 0."""
    result = break_even(effect(0, 1), effect(20, 0, first_scene=10))
    assert result.low == 0.0 < result.p_star < result.high
    assert result.shares.always == pytest.approx((1 - 1 / N) ** N, abs=0.04)
    # A gain of one scene: as many resamples are favoured never, p* = 1.
    rare = break_even(effect(0, 20, first_scene=10), effect(1, 0))
    assert rare.low < rare.p_star < rare.high == 1.0
    assert rare.shares.never == pytest.approx((1 - 1 / N) ** N, abs=0.04)
    # And read from below: gains at p = 0, a rare loss at p = 1.
    mirrored = break_even(effect(20, 0, first_scene=10), effect(0, 1))
    assert mirrored.low < mirrored.p_star < mirrored.high == 1.0
    assert mirrored.shares.always == rare.shares.never
    # A rare gain at p = 0 that most losses at p = 1 outweigh: never favoured counts as 0.
    lost = break_even(effect(1, 0), effect(0, 20, first_scene=10))
    assert (lost.direction, lost.low) == ("below", 0.0)
    assert lost.high < 0.5
    assert lost.shares.never == rare.shares.never


def test_always_never_and_no_difference():
    always = break_even(effect(10, 0), effect(12, 0))
    assert (always.p_star, always.interval, always.words) == (0.0, (0.0, 0.0), "always favoured")
    never = break_even(effect(0, 10), effect(0, 12))
    assert (never.p_star, never.interval, never.words) == (None, None, "never favoured")
    assert (never.share_without_crossing, never.shares.never) == (1.0, 1.0)
    same = break_even(effect(0, 0), effect(0, 0))
    assert same.words == "no difference at any fault frequency"


def test_tiny_frequencies_are_not_printed_as_zero():
    effects = [effect(0, 1), effect(20, 0, first_scene=10)]
    effects[1] = type(effects[1])(**{**vars(effects[1]), "value": 1000.0})
    assert break_even(*effects).words == "favoured above 0.2 % fault frequency"


def test_effects_on_other_resamples_are_refused():
    other = Resamples.draw("elsewhere", N, n_resamples=2000)
    with pytest.raises(ValueError, match="same resamples"):
        break_even(effect(1, 2), success_effect(np.ones(N), np.zeros(N), other))


def test_a_break_even_result_must_be_consistent():
    base = {"words": "w", "method": "m", "estimand": "e"}
    with pytest.raises(ValueError, match="exactly when the direction is never"):
        BreakEven(p_star=None, direction="above", **base)
    with pytest.raises(ValueError, match="both ends or neither"):
        BreakEven(p_star=0.5, low=0.1, direction="above", **base)
