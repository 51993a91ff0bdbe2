"""A contrast is of trials that met the same conditions; other pairs are void."""

import weakref
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from outcomes import outcome, trial

from faultpath.core.errors import UserError
from faultpath.report.sentences.findings import describe
from faultpath.run.pairing import Group, Pairs, pair
from faultpath.run.trials import Trial, Trials
from faultpath.system import Status
from faultpath.system.outcome import Outcome

ONE, TWO = Group("repair", "shared"), Group("baseline", "shared")
SCENES = ("a", "b", "c")
SEEDS = (3, 5)


def _table(change: Callable[[Trial], Trial] = lambda row: row) -> Trials:
    """Only the repair succeeds in `a`; both do in `b`; with seed 5 only the baseline in `c`."""
    wins = {ONE: {"a": SEEDS, "b": SEEDS, "c": ()}, TWO: {"a": (), "b": SEEDS, "c": (5,)}}
    return Trials.of(
        change(_trial(side, seed, index, seed in wins[side][scene]))
        for side in (ONE, TWO)
        for seed in SEEDS
        for index, scene in enumerate(SCENES)
    )


def _trial(side: Group, seed: int, index: int, success: bool) -> Trial:
    status = Status.SUCCESS if success else Status.CRASH
    fields = {"scene": SCENES[index], "time_s": 2.0 + seed, "metrics": {"distance": 1.0}}
    return trial(side.variant, side.condition, index, status, seed=seed, **fields)


def whole(pairs: Pairs) -> list[str]:
    """Return the scenes without a void pair."""
    return [scene.id for scene in pairs.whole().scenes]


def _altering(variant: str, scene: str, seed: int, **fields: object) -> Trials:
    def change(row: Trial) -> Trial:
        if (row.variant, row.outcome.scene, row.seed) != (variant, scene, seed):
            return row
        return replace(row, outcome=replace(row.outcome, **fields))

    return _table(change)


def test_pairs_are_by_scene_and_seed():
    pairs = pair(_table(), ONE, TWO)
    assert [(scene.id, scene.index) for scene in pairs.scenes] == [("a", 0), ("b", 1), ("c", 2)]
    assert (len(pairs.void), pairs.void.sum()) == (len(SEEDS), 0)
    np.testing.assert_array_equal(pairs.success[0], [[1, 1], [1, 1], [0, 0]])
    np.testing.assert_array_equal(pairs.success[1], [[0, 0], [1, 1], [0, 1]])
    np.testing.assert_array_equal(pairs.ended(Status.CRASH)[1], 1 - pairs.success[1])
    np.testing.assert_array_equal(pairs.time_s[0], [[5.0, 7.0]] * 3)
    np.testing.assert_array_equal(pairs.metric("distance")[0], np.ones((3, 2)))


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("initial_hash", "initial states"),
        ("disturbance_hash", "disturbances"),
        ("planner_noise_hash", "planner noise"),
    ],
)
def test_other_conditions_void_the_pair_and_name_both_hashes(name, what):
    table = _altering("repair", "b", 5, **{name: "other"})
    pairs = pair(table, ONE, TWO)
    assert (pairs.void.sum(), whole(pairs)) == (1, ["a", "c"])
    (unpaired,) = pairs.unpaired
    sentence = describe(unpaired)
    assert f"in scene 'b' (seed 5): their {what} differ ({name} 'other' and " in sentence
    assert repr(getattr(outcome("b", seed=5), name)) in sentence
    np.testing.assert_array_equal(pairs.whole().success[1], [[0, 0], [0, 1]])


def test_planners_that_draw_differently_are_pairs_all_the_same():
    table = _altering("repair", "b", 5, planner_noise_hash="other")
    assert pair(table, ONE, TWO, other_noise=True).unpaired == ()
    table = _altering("repair", "b", 5, initial_hash="other")
    assert len(pair(table, ONE, TWO, other_noise=True).unpaired) == 1


def test_a_failed_trial_voids_its_pair_and_leaves_its_scene_out():
    table = _altering("baseline", "b", 3, status=Status.FAILED, initial_hash="", time_s=0.0)
    pairs = pair(table, ONE, TWO)
    assert (pairs.void.sum(), whole(pairs)) == (1, ["a", "c"])
    np.testing.assert_array_equal(pairs.whole().success[0], [[1, 1], [0, 0]])
    np.testing.assert_array_equal(pairs.whole().time_s[0], [[5.0, 7.0]] * 2)


def test_when_every_scene_is_void_nothing_is_left():
    def fail(row: Trial) -> Trial:
        return replace(row, outcome=replace(row.outcome, status=Status.FAILED))

    pairs = pair(_table(fail), ONE, TWO)
    assert (pairs.void.sum(), whole(pairs)) == (6, [])
    assert pairs.whole().success[0].shape == pairs.whole().time_s[0].shape == (0, 2)


def test_pairs_can_be_cut_to_common_scenes():
    pairs = pair(_table(), ONE, TWO).only(("c", "b"))
    assert [scene.id for scene in pairs.scenes] == ["b", "c"]
    np.testing.assert_array_equal(pairs.success[1], [[1, 1], [0, 1]])


def test_a_metric_that_a_trial_lacks_is_not_a_number_there():
    table = _altering("repair", "a", 3, metrics={})
    pairs = pair(table, ONE, TWO)
    missing = [np.isnan(values) for values in pairs.metric("distance")]
    assert missing[0].sum() == 1
    assert missing[0][SCENES.index("a"), SEEDS.index(3)]
    assert not missing[1].any()


def test_sides_of_different_extent_are_refused():
    short = Trials.of(tuple(row for row in [*_table()][:-1]))
    with pytest.raises(UserError, match="different scenes, for example 'c'"):
        pair(short, ONE, TWO)
    with pytest.raises(UserError, match="no trial of baseline under correct with seed 3"):
        pair(_table(), ONE, Group("baseline", "correct"))
    with pytest.raises(UserError, match="repair under correct"):
        pair(_table(), Group("repair", "correct"), TWO)


def test_what_was_run_once_is_paired_with_every_seed_of_the_other_side():
    """Its planner drew with its own seed, so that noise counts only where seeds agree."""
    once = Group("baseline", "shared", once=3)
    rows = tuple(row for row in _table() if (row.variant, row.seed) != ("baseline", 5))
    for first, second in ((ONE, once), (once, ONE)):
        pairs = pair(Trials.of(rows), first, second, SEEDS)
        assert (len(pairs.void), pairs.void.sum()) == (len(SEEDS), 0)
        its = 0 if first == once else 1
        np.testing.assert_array_equal(pairs.success[its], [[0, 0], [1, 1], [0, 0]])
        assert pairs.time_s[its].tolist() == [[5.0, 5.0]] * 3
    assert pair(_altering("repair", "a", 3, planner_noise_hash="x"), ONE, once).void.sum() == 1
    assert pair(_altering("repair", "a", 5, planner_noise_hash="x"), ONE, once).void.sum() == 0
    assert pair(_altering("repair", "a", 5, initial_hash="x"), ONE, once).void.sum() == 1
    with pytest.raises(UserError, match="with seed 4"):
        pair(_table(), ONE, Group("baseline", "shared", once=4), SEEDS)


def test_trials_that_share_nothing_do_not_take_all_memory():
    trials = [trial(f"v{n}", f"c{n}", n, seed=n) for n in range(100)]
    with pytest.raises(ValueError, match="hardly any variant"):
        Trials.of(trials)
    with pytest.raises(ValueError, match="two trials have the same"):
        Trials.of([trials[0], trials[0]])


def test_a_table_holds_its_trials_as_arrays_alone():
    outcomes = list[weakref.ref[Outcome]]()

    def rows() -> Iterator[Trial]:
        for index in range(3):
            assert not any(outcome() for outcome in outcomes[:-1])  # the last may be a variable
            row = _trial(ONE, 3, index, success=True)
            outcomes.append(weakref.ref(row.outcome))
            yield row
            del row

    assert len(Trials.of(rows())) == 3
