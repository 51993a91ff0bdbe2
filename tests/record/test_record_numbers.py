"""From tables with known counts to exactly their numbers."""

import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from outcome_tables import (
    BASELINE,
    REPAIR,
    arms,
    exact_p,
    paths,
    question,
    record,
    rows,
    table,
    three,
)

from faultpath.errors import UserError
from faultpath.record import CORRECT, SHARED, decide
from faultpath.trials import OutcomeTable, Status


@pytest.mark.parametrize("counts", [(40, 20, 5), (60, 3, 15), (50, 0, 0), (0, 7, 7), (94, 6, 0)])
def test_counts_make_the_effect_and_the_p_value(counts):
    both, wins, losses = counts
    (effect,) = record({CORRECT: counts}).effects
    assert effect.success.value == pytest.approx(wins - losses)  # of 100 scenes: points
    assert effect.success.unit == "pp"
    assert (effect.wins, effect.losses) == ((wins,), (losses,))
    assert effect.pairs == 100
    assert effect.joint_successes == both
    assert effect.p_value == pytest.approx(exact_p(wins, losses), rel=1e-9)
    assert effect.mid_p_value is not None
    assert effect.mid_p_value <= effect.p_value
    low, high = effect.success.low, effect.success.high
    assert low is not None
    assert high is not None
    assert low <= effect.success.value <= high


def test_cells_count_every_trial():
    made = record({CORRECT: (40, 20, 5), "observer": (10, 0, 30)})
    cells = {(cell.variant, cell.path): cell for cell in made.cells}
    assert len(cells) == 4
    assert cells[REPAIR, CORRECT].success == 60
    assert cells[BASELINE, CORRECT].success == 45
    assert cells[REPAIR, "observer"].success == 10
    assert cells[BASELINE, "observer"].success == 40
    for cell in made.cells:
        assert cell.success + cell.crash == cell.trials == 100
        assert cell.timeout == cell.failed == 0
        assert cell.success_percent == cell.success
        assert cell.struck_trials == (0 if cell.path == CORRECT else 100)
        altered = cell.path != CORRECT and cell.variant == REPAIR
        assert cell.altered_trials == (100 if altered else 0)
    assert cells[REPAIR, CORRECT].median_time_s == pytest.approx(5 + 0.01 * 29.5)


def test_the_time_is_compared_where_both_arrived():
    (effect,) = record({CORRECT: (40, 20, 5)}, slower_s=1.5).effects
    assert effect.time_s is not None
    assert effect.time_s.value == pytest.approx(1.5)
    assert effect.terminal_distance_m is not None
    assert effect.terminal_distance_m.value == pytest.approx(1.5)
    assert effect.min_clearance_m is not None
    assert effect.min_clearance_m.value == pytest.approx(0.0)


def test_without_a_joint_success_there_is_no_time_to_compare():
    (effect,) = record({CORRECT: (0, 20, 5)}).effects
    assert effect.time_s is None
    assert effect.joint_successes == 0


@pytest.mark.parametrize(
    ("correct", "fault", "direction", "p_star"),
    [
        ((50, 4, 16), (30, 24, 0), "above", 12 / 36),
        ((50, 16, 4), (30, 0, 24), "below", 12 / 36),
        ((50, 10, 0), (30, 20, 0), "always", 0.0),
        ((50, 0, 10), (30, 0, 20), "never", None),
        ((50, 0, 0), (50, 0, 0), "always", 0.0),
    ],
)
def test_break_even_follows_from_the_two_effects(correct, fault, direction, p_star):
    made = record({CORRECT: correct, "observer": fault})
    (item,) = made.break_even
    assert item.path == "observer"
    assert item.result.direction == direction
    assert item.result.p_star == (None if p_star is None else pytest.approx(p_star))
    curve = np.array(item.curve)
    d0, df = made.effects[0].success.value, made.effects[1].success.value
    assert curve[0, 0] == 0
    assert curve[-1, 0] == 1
    assert np.allclose(curve[:, 1], (1 - curve[:, 0]) * d0 + curve[:, 0] * df)
    assert (curve[:, 2] <= curve[:, 1] + 1e-9).all()
    assert (curve[:, 1] <= curve[:, 3] + 1e-9).all()


@pytest.mark.parametrize("wins", range(4, 9))
def test_a_difference_is_detected_when_interval_and_test_agree(wins):
    """Five to nothing: the interval excludes 0, but the exact test does not reject."""
    (effect,) = record({CORRECT: (50, wins, 0)}).effects
    assert effect.success.low is not None
    assert effect.success.low > 0 or wins == 4
    assert effect.detected == (exact_p(wins, 0) <= 0.05 and effect.success.low > 0)
    assert effect.detected == (wins >= 6)


def test_a_test_that_rejects_is_not_enough_where_the_interval_holds_zero(monkeypatch):
    (effect,) = record({CORRECT: (50, 20, 18)}).effects
    assert not effect.detected

    class Rejects:
        name, p_value = "always rejects", 0.0

        def rejects(self) -> bool:
            return True

    module = sys.modules["faultpath.record.decide"]  # the package calls a function so
    monkeypatch.setattr(module, "success_test", lambda *_: Rejects())
    (effect,) = record({CORRECT: (50, 20, 18)}).effects
    assert effect.p_value == 0.0
    assert not effect.detected


def test_swapping_the_arms_flips_every_sign():
    cells = {CORRECT: (50, 16, 4), "observer": (30, 3, 24)}
    one = record(cells)
    swapped = question().model_copy(update={"baseline": REPAIR, "repair": BASELINE})
    other = decide(swapped, paths(*cells), table(cells))
    for a, b in zip(one.effects, other.effects, strict=True):
        assert b.success.value == -a.success.value
        assert (b.success.low, b.success.high) == pytest.approx((-a.success.high, -a.success.low))
        assert b.p_value == a.p_value
        assert b.detected == a.detected
        assert (b.wins, b.losses) == (a.losses, a.wins)


def _with_failures(*failed: tuple[str, str, int]) -> OutcomeTable:
    """Return `(correct, observer)` trials of which some failed: variant, path, scene."""
    out = []
    for path, counts in ((CORRECT, (40, 20, 10)), ("observer", (20, 10, 30))):
        for variant, statuses in arms(counts).items():
            for v, p, i in failed:
                if (v, p) == (variant, path):
                    statuses[i] = Status.FAILED
            out += rows(variant, path, statuses)
    return OutcomeTable(tuple(out))


def test_a_failed_trial_voids_its_pair_and_shows_and_leaves_its_scene_out_of_every_path():
    # Scene 45 is won by the repair alone under correct inputs, and lost to the baseline otherwise.
    made = decide(question(), paths(CORRECT, "observer"), _with_failures((REPAIR, "observer", 45)))
    correct, observer = made.effects
    assert (correct.void_pairs, observer.void_pairs) == (0, 1)
    assert correct.pairs == observer.pairs == 99
    assert correct.wins == (19,)
    assert observer.losses == (29,)
    assert correct.success.value == pytest.approx(100 * (19 - 10) / 99)
    assert correct.p_value == pytest.approx(exact_p(19, 10))
    cells = {(cell.variant, cell.path): cell for cell in made.cells}
    assert cells[REPAIR, "observer"].failed == 1
    assert cells[REPAIR, "observer"].trials == 100
    assert cells[REPAIR, "observer"].success_percent == pytest.approx(100 * 30 / 99)


def test_scenes_that_failed_anywhere_are_left_out_together():
    failed = ((REPAIR, CORRECT, 0), (BASELINE, CORRECT, 1), (BASELINE, "observer", 2))
    made = decide(question(), paths(CORRECT, "observer"), _with_failures(*failed))
    assert [effect.pairs for effect in made.effects] == [97, 97]
    assert [effect.void_pairs for effect in made.effects] == [2, 1]


def test_when_every_pair_is_void_there_is_nothing_to_decide():
    every = tuple((REPAIR, CORRECT, i) for i in range(100))
    with pytest.raises(UserError, match="no scene is left"):
        decide(question(), paths(CORRECT, "observer"), _with_failures(*every))


def test_trials_that_met_other_conditions_are_no_pair_and_the_record_says_so():
    good = table({CORRECT: (50, 16, 4)})
    odd = replace(good.rows[7], outcome=replace(good.rows[7].outcome, disturbance_hash="storm"))
    mixed = OutcomeTable((*good.rows[:7], odd, *good.rows[8:]))
    record = decide(question(), paths(CORRECT), mixed, findings=("Something else.",))
    (effect,) = record.effects
    assert (effect.void_pairs, effect.success.n_scenes) == (1, 99)
    found, other = record.findings
    assert re.search(r"s007.*disturbances differ \(disturbance_hash .*'storm'", found)
    assert other == "Something else."


def test_several_seeds_are_averaged_within_each_scene():
    out = []
    for seed, counts in ((0, (40, 20, 5)), (1, (40, 10, 5))):
        for variant, statuses in arms(counts).items():
            out += rows(variant, CORRECT, statuses, seed=seed)
    both = decide(question(seeds=(0, 1)), paths(CORRECT), OutcomeTable(tuple(out)))
    (effect,) = both.effects
    assert effect.success.value == pytest.approx((15 + 5) / 2)
    assert (effect.wins, effect.losses) == ((20, 10), (5, 5))
    assert effect.pairs == 200
    assert effect.mid_p_value is None
    assert "sign test" in effect.test
    assert effect.success.n_seeds == 2


def test_a_seed_given_twice_over_does_not_shrink_the_p_value():
    out = []
    for seed in (0, 1, 2):
        for variant, statuses in arms((40, 9, 2)).items():
            out += rows(variant, CORRECT, statuses, seed=seed)
    (thrice,) = decide(question(seeds=(0, 1, 2)), paths(CORRECT), OutcomeTable(tuple(out))).effects
    (once,) = record({CORRECT: (40, 9, 2)}).effects
    assert thrice.p_value == pytest.approx(once.p_value)
    assert (thrice.success.low, thrice.success.high) == (once.success.low, once.success.high)


def test_effects_of_one_record_share_their_resamples():
    """Equal data on two paths: not even the interval of the change may be wider than nothing."""
    made = three((50, 10, 5), (40, 20, 5), (40, 20, 5))
    (turn,) = made.reversals
    assert (turn.change.value, turn.change.low, turn.change.high) == (0, 0, 0)
    assert made.effects[1].success == made.effects[2].success


def test_a_record_says_the_same_every_time():
    cells = {CORRECT: (50, 10, 5), "observer": (40, 3, 25), SHARED: (40, 20, 5)}
    assert record(cells) == record(cells)
