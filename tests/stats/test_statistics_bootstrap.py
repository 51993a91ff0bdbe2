"""Bootstrap effects: the laws that they must keep, against plain resampling, and their speed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from paired import conditional_effect
from scipy.stats import sem
from scipy.stats import t as student

from faultpath.core.streams import generator
from faultpath.stats.contrast import change, percentile_interval
from faultpath.stats.effects import mean_effect, median_effect, success_effect, success_rate
from faultpath.stats.estimate import SCENES, SCENES_AND_SEEDS, Estimate
from faultpath.stats.resamples import Resamples, quantiles

N = 20
RESAMPLES = Resamples.draw("laws", N, n_resamples=500)
SHAPE = st.tuples(st.just(2), st.just(N), st.integers(1, 4))
BINARY = hnp.arrays(np.bool_, SHAPE)
FLOATS = hnp.arrays(np.float64, SHAPE, elements=st.floats(-50, 50, width=32))
fewer = settings(max_examples=50, deadline=None)


def rows(resamples):
    """Spell the count matrix out as the scene indices of each resample."""
    return [np.repeat(np.arange(resamples.n_scenes), row.astype(int)) for row in resamples.counts]


def test_resamples_are_keyed_and_complete():
    again, other = (Resamples.draw("laws", N, seed=seed, n_resamples=500) for seed in (0, 1))
    assert RESAMPLES.same_as(again)
    assert not RESAMPLES.same_as(other)
    assert (RESAMPLES.counts.sum(axis=1) == N).all()
    # 10,000 scene counts of mean 1: every scene is equally likely.
    assert np.abs(RESAMPLES.counts.mean(axis=0) - 1).max() < 5 * np.sqrt(1 / 500)
    with pytest.raises(ValueError, match="read-only"):
        RESAMPLES.counts[0, 0] = 3


@pytest.mark.parametrize(
    ("n_resamples", "n_scenes"), [(10_000, 100), (10_000, 1), (3001, 37), (3, 70_001)]
)
def test_counts_are_those_of_the_scenes_drawn_one_resample_after_another(n_resamples, n_scenes):
    """However the counting is done: every reported interval comes of these very numbers."""
    drawn = generator("bootstrap", "plain", 4).integers(0, n_scenes, size=(n_resamples, n_scenes))
    plain = np.stack([np.bincount(row, minlength=n_scenes) for row in drawn]).astype(np.float64)
    resamples = Resamples.draw("plain", n_scenes, seed=4, n_resamples=n_resamples)
    assert resamples.counts.dtype == np.float64
    np.testing.assert_array_equal(resamples.counts, plain, strict=True)
    blocks = list(resamples.blocks())
    assert len(blocks) > 1 or n_scenes == 1
    np.testing.assert_array_equal(np.concatenate(blocks), plain, strict=True)


def test_many_scenes_have_the_same_draws_in_a_byte_for_each_count(monkeypatch):
    few = Resamples.draw("many", 400, n_resamples=1000)
    monkeypatch.setattr("faultpath.stats.resamples._MOST_CELLS", 399_999)
    many = Resamples.draw("many", 400, n_resamples=1000)
    assert (few.counts.dtype, many.counts.dtype) == (np.float64, np.uint8)
    np.testing.assert_array_equal(many.counts, few.counts)
    values = np.random.default_rng(0).normal(size=(400, 2))
    np.testing.assert_allclose(many.sums(values), few.sums(values), rtol=1e-13)
    scenes = np.arange(400, dtype=np.intp)
    medians = [quantiles(each.counts, values[:, 0], scenes, 0.5) for each in (few, many)]
    np.testing.assert_array_equal(*medians)


@fewer
@given(FLOATS)
def test_draws_are_the_means_of_resampled_scenes(pair):
    means = (pair[0] - pair[1]).mean(axis=1)
    expected = [means[row].mean() for row in rows(RESAMPLES)]
    effect = mean_effect(*pair, RESAMPLES, "m")
    np.testing.assert_allclose(effect.draws, expected, atol=1e-10)
    assert effect.value == pytest.approx(means.mean(), abs=1e-10)
    low, high = effect.ends(0.9)
    assert (low, high) == pytest.approx(np.percentile(expected, [5, 95]), abs=1e-9)


@fewer
@given(BINARY.filter(lambda pair: pair.shape[2] > 1))
def test_newly_trained_models_have_the_hull_of_score_and_students_t(pair):
    trained = conditional_effect(*pair, RESAMPLES, models=True)
    given_ = conditional_effect(*pair, RESAMPLES)
    assert trained.estimate().estimand == SCENES_AND_SEEDS
    assert given_.estimate().estimand == SCENES
    moved = change(conditional_effect(*pair[::-1], RESAMPLES), given_)
    other = change(conditional_effect(*pair[::-1], RESAMPLES, models=True), trained)
    for wide, score in ((trained, given_), (other, moved)):
        low, high = score.interval
        seeds = np.array(wide.per_seed)
        if len(set(wide.per_seed)) > 1 and seeds.var(ddof=1) > (100 / N) ** 2 / 12:
            ends = student.interval(0.95, len(seeds) - 1, seeds.mean(), sem(seeds))
            low, high = min(low, ends[0]), max(high, ends[1])
            assert wide.interval == pytest.approx((low, high))
        assert wide.interval[0] <= low + 1e-9
        assert high - 1e-9 <= wide.interval[1]
    backward = conditional_effect(*pair[::-1], RESAMPLES, models=True)
    low, high = trained.interval
    assert (backward.value, backward.interval) == (-trained.value, pytest.approx((-high, -low)))


def test_newly_trained_models_without_discordance_are_not_known_to_be_equal():
    """Resampled trainings alone printed [0.0, 0.0]."""
    some = np.arange(60).reshape(N, 3) % 2
    effect = conditional_effect(some, some, RESAMPLES, models=True)
    assert effect.interval == conditional_effect(some, some, RESAMPLES).interval
    low, high = change(effect, effect).interval
    assert low == -high < -10


@fewer
@given(BINARY)
def test_swapping_the_variants_flips_the_sign_and_mirrors_the_interval(pair):
    forward, backward = (mean_effect(*variants, RESAMPLES, "m") for variants in (pair, pair[::-1]))
    low, high = forward.interval
    assert (backward.value, backward.interval) == (-forward.value, (-high, -low))
    assert backward.per_seed == tuple(-value for value in forward.per_seed)


def test_a_resampled_mean_of_zero_is_exactly_zero():
    """Thirds do not cancel in floating point; an end at 0 must not come out beside it."""
    first, second = np.zeros((2, N, 3))
    first[:7, 0], second[7:14, 1] = 1, 1
    draws = conditional_effect(first, second, RESAMPLES).draws
    assert (draws == 0).sum() > 20
    assert np.abs(draws[draws != 0]).min() > 1


def test_per_seed_values_and_counts():
    first = np.array([[1, 0], [1, 0], [0, 1], [0, 0]])
    second = np.array([[0, 0], [0, 1], [0, 0], [0, 0]])
    estimate = conditional_effect(first, second, Resamples.draw("four", 4)).estimate()
    assert estimate.per_seed == (50.0, 0.0)
    assert (estimate.value, estimate.won) == (25.0, ((2, 0), (1, 1)))
    assert (estimate.n_scenes, estimate.n_seeds, estimate.unit) == (4, 2, "pp")
    assert estimate.method == "score on scene means (Tango's, cluster-robust)"


@fewer
@given(BINARY, BINARY)
def test_a_change_is_joint(a, b):
    effect_a, effect_b = (conditional_effect(*pair, RESAMPLES) for pair in (a, b))
    moved = change(effect_a, effect_b)
    np.testing.assert_allclose(moved.draws, effect_b.draws - effect_a.draws, atol=1e-9)
    assert moved.value == pytest.approx(effect_b.value - effect_a.value, abs=1e-9)
    assert len(moved.per_seed) == (a.shape[2] if a.shape == b.shape else 0)
    none = change(effect_a, effect_a)
    assert not none.draws.any()
    assert not none.scenes.values.any()
    low, high = none.interval
    assert low == -high < 0


ONE, THREE = np.ones((N, 2)), np.ones((N, 3))
HERE, TRAINED = (conditional_effect(ONE, ONE, RESAMPLES, models=models) for models in (False, True))
ELSEWHERE = conditional_effect(ONE, ONE, Resamples.draw("other", N, n_resamples=500))


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: change(HERE, ELSEWHERE), "same resamples"),
        (lambda: change(HERE, success_effect(ONE, ONE)), "same resamples"),
        (
            lambda: change(success_effect(ONE, ONE), success_effect(ONE[1:], ONE[1:])),
            f"of {N} and of {N - 1} scenes",
        ),
        (lambda: change(HERE, mean_effect(ONE, ONE, RESAMPLES, "m")), "'pp' and 'm'"),
        (lambda: change(HERE, TRAINED), "one effect is for new seeds"),
        (
            lambda: change(TRAINED, conditional_effect(THREE, THREE, RESAMPLES, models=True)),
            "same seeds",
        ),
        (
            lambda: conditional_effect(np.ones(19), np.ones(19), RESAMPLES),
            "19 scenes, the resamples",
        ),
        (lambda: success_rate(np.full(N, 2.0), RESAMPLES), "only 0 and 1"),
        (lambda: conditional_effect(ONE[:, 0], ONE[:, 0], RESAMPLES, models=True), "one seed"),
        (lambda: mean_effect(ONE, THREE, RESAMPLES, "m"), "one shape"),
        (lambda: Resamples.draw("none", 5, n_resamples=0), "0 resamples of 5 scenes"),
        (lambda: percentile_interval(np.zeros(3), 95), "level of an interval"),
        (lambda: HERE.ends(95.0), "level of an interval"),
    ],
)
def test_what_is_wrong_or_not_joint_is_refused(wrong, says):
    with pytest.raises(ValueError, match=says):
        wrong()


@fewer
@given(FLOATS, st.data())
def test_medians_are_those_of_the_resampled_joint_scenes(pair, data):
    joint = data.draw(hnp.arrays(np.bool_, pair.shape[1:]).filter(lambda mask: mask.any()))
    effect = median_effect(*pair, joint, RESAMPLES)
    within = [
        (first - second)[seen].mean() if seen.any() else None
        for first, second, seen in zip(*pair, joint, strict=True)
    ]
    seen = [[within[i] for i in row if within[i] is not None] for row in rows(RESAMPLES)]
    expected = [np.median(values) for values in seen if values]
    np.testing.assert_allclose(effect.draws, expected, atol=1e-9)
    assert effect.value == pytest.approx(np.median([w for w in within if w is not None]))
    assert effect.n_scenes == joint.any(axis=1).sum()


def test_medians_take_every_resample_in_order():
    resamples = Resamples.draw("several blocks", 100, n_resamples=1501)
    assert len(list(resamples.blocks())) > 1
    first, second = np.random.default_rng(0).normal(size=(2, 100))
    joint = np.arange(100) % 3 == 0
    expected = [np.median((first - second)[row[joint[row]]]) for row in rows(resamples)]
    draws = median_effect(first, second, joint, resamples).draws
    np.testing.assert_array_equal(draws, expected, strict=True)


def test_times_of_scenes_that_are_not_joint_are_not_read():
    first, second = np.full(N, 3.0), np.full(N, 2.0)
    joint = np.arange(N) < 15
    first[15:] = np.nan
    found = median_effect(first, second, joint, RESAMPLES)
    assert (found.value, found.interval, found.n_scenes) == (1.0, (1.0, 1.0), 15)
    with pytest.raises(ValueError, match="no scene is jointly successful"):
        median_effect(first, second, np.zeros(N, dtype=bool), RESAMPLES)
    with pytest.raises(ValueError, match="need one shape"):
        median_effect(first[:3], second, joint, RESAMPLES)
    with pytest.raises(ValueError, match="first holds NaN"):
        median_effect(first, second, np.ones(N, dtype=bool), RESAMPLES)


def test_an_estimate_refuses_nonsense():
    base = {"method": "m", "estimand": SCENES, "n_scenes": 100, "n_seeds": 3, "unit": "pp"}
    estimate = Estimate(value=-9.67, low=-16.0, high=-4.0, **base)
    assert Estimate.model_validate_json(estimate.model_dump_json()) == estimate
    for ends, says in (((), "finite"), ((1.0,), "both ends"), ((1.0, -1.0), "upside down")):
        wrong = dict(zip(("low", "high"), ends, strict=False))
        with pytest.raises(ValueError, match=says):
            Estimate(value=0.0 if ends else float("nan"), **wrong, **base)
