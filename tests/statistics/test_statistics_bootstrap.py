"""Bootstrap effects: the laws that they must keep, against plain resampling, and their speed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.stats import sem
from scipy.stats import t as student

from faultpath.statistics import (
    Resamples,
    change,
    mean_effect,
    median_effect,
    percentile_interval,
    success_effect,
)
from faultpath.statistics.estimate import SCENES, SCENES_AND_SEEDS

N = 20
RESAMPLES = Resamples.draw("laws", N, n_resamples=500)
BINARY = hnp.arrays(np.bool_, st.tuples(st.just(2), st.just(N), st.integers(1, 4)))
FLOATS = hnp.arrays(
    np.float64,
    st.tuples(st.just(2), st.just(N), st.integers(1, 4)),
    elements=st.floats(-50, 50, width=32),
)
fewer = settings(max_examples=50, deadline=None)


def rows(resamples):
    """Spell the count matrix out as the scene indices of each resample."""
    return [np.repeat(np.arange(resamples.n_scenes), row.astype(int)) for row in resamples.counts]


def test_resamples_are_keyed_and_complete():
    again, other = (
        Resamples.draw("laws", N, n_resamples=500),
        Resamples.draw("laws", N, seed=1, n_resamples=500),
    )
    assert RESAMPLES.same_as(again)
    assert not RESAMPLES.same_as(other)
    assert (RESAMPLES.counts.sum(axis=1) == N).all()
    # 10,000 scene counts of mean 1: every scene is equally likely.
    assert np.abs(RESAMPLES.counts.mean(axis=0) - 1).max() < 5 * np.sqrt(1 / 500)
    with pytest.raises(ValueError, match="read-only"):
        RESAMPLES.counts[0, 0] = 3


@fewer
@given(BINARY.filter(lambda pair: pair.shape[2] > 1))
def test_newly_trained_models_have_the_hull_of_score_and_students_t(pair):
    trained = success_effect(*pair, RESAMPLES, models=True)
    given_ = success_effect(*pair, RESAMPLES)
    assert trained.estimate().estimand == SCENES_AND_SEEDS
    assert given_.estimate().estimand == SCENES
    moved = change(success_effect(*pair[::-1], RESAMPLES), given_)
    other = change(success_effect(*pair[::-1], RESAMPLES, models=True), trained)
    for wide, score in ((trained, given_), (other, moved)):
        low, high = score.interval
        seeds = np.array(wide.per_seed)
        if len(set(wide.per_seed)) > 1 and seeds.var(ddof=1) > (100 / N) ** 2 / 12:
            ends = student.interval(0.95, len(seeds) - 1, seeds.mean(), sem(seeds))
            low, high = min(low, ends[0]), max(high, ends[1])
            assert wide.interval == pytest.approx((low, high))
        assert wide.interval[0] <= low + 1e-9
        assert high - 1e-9 <= wide.interval[1]
    backward = success_effect(*pair[::-1], RESAMPLES, models=True)
    low, high = trained.interval
    assert (backward.value, backward.interval) == (-trained.value, pytest.approx((-high, -low)))


@fewer
@given(BINARY, st.booleans())
def test_swapping_the_arms_flips_the_sign_and_mirrors_the_interval(pair, as_floats):
    pair = pair * 0.1 if as_floats else pair
    forward, backward = (
        mean_effect(*arms, RESAMPLES, "m") if as_floats else success_effect(*arms, RESAMPLES)
        for arms in (pair, pair[::-1])
    )
    low, high = forward.interval
    assert (backward.value, backward.interval) == (-forward.value, (-high, -low))
    assert backward.per_seed == tuple(-value for value in forward.per_seed)


@fewer
@given(BINARY, st.integers(2, 3))
def test_duplicating_seeds_changes_neither_value_nor_interval(pair, times):
    once = success_effect(*pair, RESAMPLES)
    copied = success_effect(*np.tile(pair, (1, 1, times)), RESAMPLES)
    assert (copied.value, copied.interval) == (once.value, once.interval)


@fewer
@given(BINARY, BINARY)
def test_a_change_is_joint(a, b):
    effect_a, effect_b = (success_effect(*pair, RESAMPLES) for pair in (a, b))
    moved = change(effect_a, effect_b)
    np.testing.assert_allclose(moved.draws, effect_b.draws - effect_a.draws, atol=1e-9)
    assert moved.value == pytest.approx(effect_b.value - effect_a.value, abs=1e-9)
    assert len(moved.per_seed) == (a.shape[2] if a.shape == b.shape else 0)
    none = change(effect_a, effect_a)
    assert not none.draws.any()
    assert not none.scenes.values.any()
    low, high = none.interval
    assert low == -high < 0


def test_wrong_input_is_refused():
    with pytest.raises(ValueError, match="19 scenes, the resamples 'laws' have 20"):
        success_effect(np.ones(19), np.ones(19), RESAMPLES)
    with pytest.raises(ValueError, match="one seed says nothing"):
        success_effect(np.ones(N), np.ones(N), RESAMPLES, models=True)
    with pytest.raises(ValueError, match="one shape"):
        mean_effect(np.ones((N, 1)), np.ones((N, 3)), RESAMPLES, "m")
    with pytest.raises(ValueError, match="0 resamples of 5 scenes"):
        Resamples.draw("none", 5, n_resamples=0)
    with pytest.raises(ValueError, match="level of an interval"):
        percentile_interval(np.zeros(3), 95)


@fewer
@given(FLOATS, st.data())
def test_medians_are_those_of_the_resampled_joint_scenes(pair, data):
    joint = data.draw(hnp.arrays(np.bool_, pair.shape[1:]).filter(lambda mask: mask.any()))
    effect = median_effect(*pair, joint, RESAMPLES)
    within = [
        (first - second)[seen].mean() if seen.any() else None
        for first, second, seen in zip(*pair, joint, strict=True)
    ]
    expected = [
        np.median([within[scene] for scene in row if within[scene] is not None])
        for row in rows(RESAMPLES)
        if any(within[scene] is not None for scene in row)
    ]
    np.testing.assert_allclose(effect.draws, expected, atol=1e-9)
    assert effect.value == pytest.approx(np.median([w for w in within if w is not None]))
    assert effect.n_scenes == joint.any(axis=1).sum()
