"""Errors that cancel: each decision once, its exact tests, and the laws of a scan."""

from itertools import combinations

import numpy as np
import pytest
import simulation_scan as scans
from paired import holm
from scipy.stats import binomtest
from simulation import kept
from simulation_skewed import Skewed

from faultpath.stats import score
from faultpath.stats.cancelling import ahead, cancelling, fewest_scenes, stage_one

SCENES = 60


def successes(*counts, scenes=SCENES):
    """Return outcomes [counts, scenes] of which the first succeed: one more never costs a scene."""
    return (np.arange(scenes) < np.array(counts)[:, np.newaxis]).astype(float)


def drawn(seed, errors=5, seeds=1):
    """Return outcomes without an error, with each alone and with each pair, of a scan in which much
    is decided."""
    rng = np.random.default_rng(seed)
    rates = np.array([0.85, *rng.uniform(0.1, 0.9, errors)])
    pairs = list(combinations(range(errors), 2))
    rates = np.concatenate([rates, rng.uniform(0.3, 0.9, len(pairs))])
    outcomes = (rng.random((len(rates), SCENES, seeds)) < rates[:, np.newaxis, np.newaxis]).mean(-1)
    return (
        outcomes[0],
        outcomes[1 : errors + 1],
        dict(zip(pairs, outcomes[errors + 1 :], strict=True)),
    )


@pytest.mark.parametrize(
    ("first", "second", "both", "same_source", "kind", "covering", "alone"),
    [
        (20, 24, 50, False, "cancel", None, ("hurts", "hurts")),
        (20, 24, 50, True, "cancel", None, ("hurts", "hurts")),
        (20, 24, 36, False, "cancel", None, ("hurts", "hurts")),
        (20, 24, 35, False, None, None, ("hurts", "hurts")),
        (20, 24, 20, False, None, None, ("hurts", "hurts")),
        (20, 40, 39, False, None, None, ("hurts", "hurts")),
        (20, 40, 40, False, "cancel", None, ("hurts", "hurts")),
        (20, 52, 50, False, None, None, ("hurts", None)),
        (20, 52, 50, True, "covers", 1, ("hurts", None)),
        (48, 20, 50, True, "covers", 0, (None, "hurts")),
        (20, 53, 50, True, None, None, ("hurts", None)),
        (20, 60, 52, True, None, None, ("hurts", "helps")),
        (52, 52, 60, True, None, None, (None, None)),
        (52, 52, 52, True, None, None, (None, None)),
    ],
)
def test_each_kind_of_pair(first, second, both, same_source, kind, covering, alone):
    """52 scenes of 60 succeed without an error."""
    none, *others = successes(52, first, second, both)
    same = {(0, 1)} if same_source else set()
    result = cancelling(none, dict(enumerate(others[:2])), {(0, 1): others[2]}, same)
    pair = result.pairs[0, 1]
    assert (pair.kind, pair.covering) == (kind, covering)
    assert tuple(single.kind for single in result.singles.values()) == alone
    shown = np.array([pair.none, pair.first, pair.second, pair.both])
    np.testing.assert_allclose(shown, np.array([52, first, second, both]) / 0.6)
    lost = 52 - min(first, second)
    expected = (both - min(first, second)) / lost if lost else None
    assert pair.regained == (expected if expected is None else pytest.approx(expected))


def test_p_values_are_exact_mcnemars_by_holm():
    none, singles, pairs = drawn(1)
    result = cancelling(none, dict(enumerate(singles)), pairs, set())
    exact = [binomial(none, values) for values in singles]
    assert [single.p_value for single in result.singles.values()] == pytest.approx(exact)
    corrected = [single.corrected_p for single in result.singles.values()]
    assert corrected == pytest.approx(holm(exact))
    hurt = [pair for pair in pairs if all(result.singles[e].kind == "hurts" for e in pair)]
    assert len(hurt) > 2
    worse = [min(pair, key=lambda error: singles[error].mean()) for pair in hurt]
    exact = [
        min(1.0, 2.0 * binomial(pairs[pair], singles[error]))
        for pair, error in zip(hurt, worse, strict=True)
    ]
    assert [result.pairs[pair].p_value for pair in hurt] == pytest.approx(exact)
    assert [result.pairs[pair].corrected_p for pair in hurt] == pytest.approx(holm(exact))
    assert all(result.pairs[pair].corrected_p is None for pair in pairs if pair not in hurt)


def binomial(first, second):
    wins, losses = int((first > second).sum()), int((first < second).sum())
    return binomtest(wins, wins + losses, alternative="greater").pvalue if wins + losses else 1.0


@pytest.mark.parametrize("seeds", [1, 3])
def test_permuted_errors_permute_the_results(seeds):
    none, singles, pairs = drawn(2, seeds=seeds)
    same = {(0, 1), (2, 3)}
    order = np.array([3, 0, 4, 1, 2])
    place = np.argsort(order).tolist()
    turned = {(place[b], place[a]): values for (a, b), values in pairs.items()}
    result = cancelling(none, dict(enumerate(singles)), pairs, same)
    turned_same = {(place[b], place[a]) for a, b in same}
    other = cancelling(none, dict(enumerate(singles[order])), turned, turned_same)
    assert {pair.kind for pair in result.pairs.values()} == {"cancel", "covers", None}
    assert list(other.singles.values()) == [result.singles[error] for error in order]
    for (a, b), pair in result.pairs.items():
        covering = None if pair.covering is None else place[pair.covering]
        expected = pair._replace(
            first=pair.second, second=pair.first, worse=place[pair.worse], covering=covering
        )
        assert other.pairs[place[b], place[a]] == expected
    first, again = stage_one(none, singles), stage_one(none, singles[order])
    assert again.hurting == tuple(place[error] for error in first.hurting)


def test_the_order_of_scenes_decides_nothing_where_rates_are_equal():
    """Thirds added in another order differ in the last bit, which tells of no gain."""
    rng = np.random.default_rng(0)
    none = rng.integers(1, 4, SCENES) / 3.0
    alone = {0: rng.permutation(none), 1: np.zeros(SCENES)}
    orders = [rng.permutation(SCENES) for _ in range(20)]
    gains = {float(alone[0][order].sum() - none[order].sum()) for order in orders}
    assert min(gains) < 0.0 < max(gains)
    for order in orders:
        permuted = {error: values[order] for error, values in alone.items()}
        result = cancelling(none[order], permuted, {(0, 1): none[order]}, {(0, 1)})
        assert (result.pairs[0, 1].kind, result.pairs[0, 1].covering) == ("covers", 0)


def test_a_scene_counts_where_both_sides_have_an_outcome():
    none, singles, pairs = drawn(3)
    whole = cancelling(none, dict(enumerate(singles)), pairs, set())
    blank = np.full((1, 7), np.nan)

    def longer(values):
        return np.concatenate([values, np.repeat(blank, len(values), axis=0)], axis=1)

    more = {key: longer(values[np.newaxis])[0] for key, values in pairs.items()}
    alone = dict(enumerate(longer(singles)))
    assert cancelling(longer(none[np.newaxis])[0], alone, more, set()) == whole
    singles[0, :20] = np.nan
    pairs[1, 2][:5] = np.nan
    result = cancelling(none, dict(enumerate(singles)), pairs, set())
    assert [single.scenes for single in result.singles.values()] == [40, 60, 60, 60, 60]
    assert result.singles[0].none == pytest.approx(100.0 * none[20:].mean())
    assert [result.pairs[key].scenes for key in ((0, 1), (1, 2), (2, 3))] == [40, 55, 60]
    singles[1] = np.nan
    assert cancelling(none, dict(enumerate(singles)), pairs, set()).pairs[1, 2].kind is None


@pytest.mark.parametrize(("errors", "fewest"), [(2, 7), (4, 9), (10, 12)])
def test_with_fewer_scenes_than_the_correction_needs_nothing_cancels(errors, fewest):
    keys = list(combinations(range(errors), 2))
    assert fewest_scenes(errors, len(keys)) == fewest
    for scenes, kind in ((fewest - 1, None), (fewest, "cancel")):
        succeed, fail = np.ones(scenes), dict.fromkeys(range(errors), np.zeros(scenes))
        result = cancelling(succeed, fail, dict.fromkeys(keys, succeed), set())
        assert {pair.kind for pair in result.pairs.values()} == {kind}


def test_at_most_ten_errors_that_hurt_go_on_the_worst_first():
    none, *singles = successes(50, *range(50, 34, -1))
    stage = stage_one(none, np.stack(singles))
    assert stage.losses[5] == pytest.approx(100 * 5 / 60)
    assert stage.hurting == tuple(range(15, 5, -1))
    few = stage_one(none, np.stack(singles[:6]))
    assert few.p_values[[3, 4]] == pytest.approx([0.125, 0.0625])
    assert few.hurting == (5, 4)


def test_seeds_that_end_alike_count_once_and_others_take_the_larger_test():
    none, singles, _ = drawn(4, seeds=3)
    alike = np.round(none), np.round(singles)
    exact = [binomial(alike[0], values) for values in alike[1]]
    assert ahead(*alike) == pytest.approx(exact)
    for values, p_value in zip(singles, ahead(none, singles), strict=True):
        kinds, counts = np.unique((none - values).round(9), return_counts=True)
        by_score = 0.5 * score.p_value(kinds, counts.astype(float), 1.0)
        wins = (none - values).sum()
        assert p_value >= by_score if wins > 0 else p_value >= 0.5


def test_several_seeds_keep_their_level_where_scenes_win_by_little_and_lose_by_much():
    population = Skewed.even(200, 3, 0.02, 1, 0.0)
    counts = np.random.default_rng(5).multinomial(200, population.chances, size=2000)
    values = np.arange(-3, 4) / 3
    differences = np.stack([np.repeat(values, row) for row in counts])
    for level in (0.025, 0.0025):
        assert kept((ahead(differences, np.zeros(200)) <= level).mean(), 2000, most=level)


@pytest.mark.parametrize("truth", scans.TRUTHS)
def test_false_cancellations_are_rare(truth):
    assert kept(scans.false_claims(truth, 50, 8, 0.95, runs=60)[0], 60, most=0.05)


def test_a_pair_that_cancels_is_reported_beside_errors_that_add_up():
    assert scans.power(0.05, 0.8, 8000, runs=20) > 0.6
