"""Break-even frequencies: the set of undecided frequencies, what it says and what it never says."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paired import conditional_effect, counted

from faultpath.stats.breakeven import break_even, mixture_curve
from faultpath.stats.resamples import Resamples

N = 100
RESAMPLES = Resamples.draw("break-even", N, n_resamples=400)


def effect(wins, losses, first_scene=0):
    """An effect in which the named number of scenes is won and lost, from ``first_scene`` on."""
    return conditional_effect(*counted(wins, losses, N, first_scene), RESAMPLES)


@pytest.mark.parametrize(
    ("delta_0", "delta_f", "expected"),
    [
        (-10.0, 30.0, 0.25),
        (10.0, -30.0, 0.25),
        (0.0, 2.0, 0.0),
        (-1.0, 0.0, 1.0),
        (1.0, 2.0, None),
        (-1.0, -2.0, None),
        (0.0, 0.0, None),
    ],
)
def test_the_point_is_where_the_estimates_cross(delta_0, delta_f, expected):
    effects = (effect(max(0, int(delta)), max(0, -int(delta))) for delta in (delta_0, delta_f))
    assert break_even(*effects).p_star == expected


@pytest.mark.parametrize(
    ("correct", "faulty", "p_star", "signs"),
    [
        (effect(2, 30), effect(60, 2), 28 / 86, [-1, 1]),
        # No cost was seen: how rare a fault may be is open all the same.
        (effect(0, 0), effect(30, 0), 0.0, [1]),
        # Cost and gain on the same scenes cancel at one half and in no other place.
        (effect(0, 40), effect(40, 0), 0.5, [-1, 1]),
    ],
)
def test_around_a_crossing_lies_an_interval_with_decided_ends(correct, faulty, p_star, signs):
    result = break_even(correct, faulty)
    ((low, high),) = result.pieces
    assert result.kind == "interval"
    assert result.p_star == pytest.approx(p_star)
    assert low <= p_star < high < 1
    ends = [(0.0, low, -1), (high, 1.0, 1)][-len(signs) :]
    assert [(r.low, r.high, r.sign) for r in result.regions] == ends


def test_ahead_at_both_ends_leaves_no_frequency_open_and_no_difference_leaves_all():
    result = break_even(effect(30, 2), effect(40, 1))
    assert (result.kind, result.pieces, result.p_star) == ("empty", (), None)
    assert [(r.low, r.high, r.sign) for r in result.regions] == [(0.0, 1.0, 1)]
    result = break_even(effect(0, 0), effect(0, 0))
    assert (result.kind, result.pieces, result.regions) == ("whole", ((0.0, 1.0),), ())
    assert result.p_star is None


def test_a_set_may_have_two_pieces():
    """6 pp on other scenes at either end: only their mixture has the scenes to decide."""
    result = break_even(effect(9, 3), effect(9, 3, first_scene=50))
    assert result.kind == "two pieces"
    (middle,) = result.regions
    assert middle.sign == 1
    assert 0 < middle.low < 0.5 < middle.high < 1


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(0, 20), min_size=4, max_size=4), st.integers(0, N))
def test_the_curves_band_holds_0_exactly_where_the_set_is(counts, shift):
    correct, faulty = effect(*counts[:2]), effect(*counts[2:], first_scene=shift)
    result = break_even(correct, faulty)
    for p, value, low, high in mixture_curve(correct, faulty):
        inside = any(a <= p <= b for a, b in result.pieces)
        near = any(abs(p - edge) < 1e-9 for piece in result.pieces for edge in piece)
        assert near or inside == (low <= 0 <= high)
        assert low <= value <= high
        for region in result.regions:
            if region.low < p < region.high:
                assert np.sign(value) == region.sign
    first, *_, last = mixture_curve(correct, faulty)
    assert first[2:] == pytest.approx(correct.interval, abs=1e-6)
    assert last[2:] == pytest.approx(faulty.interval, abs=1e-6)
