"""From tables with known counts to exactly their numbers."""

import numpy as np
import pytest
from outcome_tables import BASELINE, REPAIR, exact_p, record, three

from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.errors import UserError
from faultpath.report.sentences import words


@pytest.mark.parametrize("counts", [(40, 20, 5), (60, 3, 15), (50, 0, 0), (0, 7, 7), (94, 6, 0)])
def test_counts_make_the_effect_and_the_p_value(counts):
    both, wins, losses = counts
    made = record({CORRECT: counts})
    (effect,) = made.effects
    assert effect.value == pytest.approx(wins - losses)  # of 100 scenes: points
    assert effect.won == ((wins, losses),)
    assert effect.scenes == 100
    assert made.secondary[0].joint_successes == both
    assert effect.mcnemar_p == pytest.approx(exact_p(wins, losses), rel=1e-9)
    low, high = effect.low, effect.high
    assert low <= effect.value <= high
    assert high - low > 2, "no interval is without width"


def test_cells_count_every_trial():
    made = record({CORRECT: (40, 20, 5), "observer": (10, 0, 30)})
    cells = {(cell.variant, cell.condition): cell for cell in made.counts}
    assert {at: cell.success for at, cell in cells.items()} == {
        (REPAIR, CORRECT): 60,
        (BASELINE, CORRECT): 45,
        (REPAIR, "observer"): 10,
        (BASELINE, "observer"): 40,
    }
    for cell in made.counts:
        assert cell.success + cell.crash == cell.trials == 100
        assert cell.faulted_trials == (0 if cell.condition == CORRECT else 100)
        altered = cell.condition != CORRECT and cell.variant == REPAIR
        assert cell.altered_trials == (100 if altered else 0)
    assert cells[REPAIR, CORRECT].median_time_s == pytest.approx(5 + 0.01 * 29.5)


@pytest.mark.parametrize(
    ("correct", "fault", "p_star", "signs"),
    [
        ((50, 0, 16), (30, 24, 0), 16 / 40, [-1, 1]),
        ((50, 16, 0), (30, 0, 24), 16 / 40, [1, -1]),
        ((50, 10, 0), (30, 20, 0), None, [1]),
        ((50, 0, 10), (30, 0, 20), None, [-1]),
        ((50, 0, 0), (50, 0, 0), None, []),
    ],
)
def test_break_even_follows_from_the_two_effects(correct, fault, p_star, signs):
    made = record({CORRECT: correct, "observer": fault})
    (item,) = made.break_even
    assert item.condition == "observer"
    assert item.result.p_star == (None if p_star is None else pytest.approx(p_star))
    assert [region.sign for region in item.result.regions] == signs


@pytest.mark.parametrize(("n", "enough"), [(3, False), (6, False), (8, True)])
def test_too_few_scenes_decide_nothing_and_the_number_that_would_is_known(n, enough):
    made = record({CORRECT: (0, n, 0), "a": (0, n, 0), "b": (0, n, 0), SHARED: (0, 0, n)}, n=n)
    assert made.testing.hypotheses == 6
    assert made.testing.scenes_needed == 7  # 2 / 2^7 <= 0.05 / 2 < 2 / 2^6
    assert all(effect.significant == enough for effect in made.effects)
    assert [change.turn for change in made.changes] == ["reversal" if enough else "none"] * 2


TWO = {CORRECT: (40, 20, 10), "observer": (20, 10, 30)}


def test_a_failed_trial_costs_its_pair_and_shows_and_costs_other_conditions_nothing():
    # Scene 45 is won by the repair alone under correct inputs, and lost to the baseline otherwise.
    fails = (REPAIR, "observer", 45)
    made = record(TWO, fails=lambda row: (row.variant, row.condition, row.scene_index) == fails)
    correct, observer = made.effects
    assert (correct.void, observer.void) == (0, 1)
    assert (correct.scenes, observer.scenes, made.scenes) == (100, 99, 100)
    assert correct.won[0][0] == 20
    assert observer.won[0][1] == 29
    assert observer.value == pytest.approx(100 * (10 - 29) / 99)
    assert correct.mcnemar_p == pytest.approx(exact_p(20, 10))
    cells = {(cell.variant, cell.condition): cell for cell in made.counts}
    assert cells[REPAIR, "observer"].failed == 1
    assert cells[REPAIR, "observer"].trials == 100
    assert cells[REPAIR, "observer"].success_percent == pytest.approx(100 * 30 / 99)


def test_a_condition_without_any_pair_costs_the_others_nothing_and_is_named():
    made = record(TWO, fails=lambda row: (row.variant, row.condition) == (REPAIR, "observer"))
    (correct,) = made.effects
    assert (correct.condition, correct.scenes, correct.void) == (CORRECT, 100, 0)
    assert not made.break_even
    said = "With the fault at the observer alone, no pair of trials is left to compare"
    assert words(made).headline.startswith(said)
    assert words(made).findings[0].startswith(said)
    with pytest.raises(UserError, match="no scene is left"):
        record(TWO, fails=lambda row: row.variant == REPAIR)


def test_several_seeds_are_averaged_within_each_scene():
    (effect,) = record({CORRECT: [(40, 20, 5), (40, 10, 5)]}).effects
    assert effect.value == pytest.approx((15 + 5) / 2)
    assert effect.won == ((20, 5), (10, 5))
    assert effect.scenes == 100
    assert "score of scenes" in effect.test
    assert len(effect.per_seed) == 2


def test_seeds_that_change_nothing_are_counted_once():
    thrice = record({CORRECT: [(40, 9, 2)] * 3, "observer": [(40, 2, 9)] * 3})
    once = record({CORRECT: [(40, 9, 2)], "observer": [(40, 2, 9)]})
    for many, one in zip(thrice.effects, once.effects, strict=True):
        assert many == one
        assert many.won == one.won
    assert "All 3 seeds gave the same outcome in every trial" in " ".join(words(thrice).sentences)
    assert "seeds" not in " ".join(words(once).sentences)


@pytest.mark.parametrize(
    ("counts", "extreme"),
    [((0, 7, 0), "floor"), ((92, 4, 4), "ceiling"), ((5, 5, 0), None), ((90, 0, 8), None)],
)
def test_floor_and_ceiling_are_both_variants_below_10_or_above_90(counts, extreme):
    assert record({CORRECT: counts}).effects[0].extreme == extreme


def test_ninety_percent_is_no_ceiling_in_the_last_bit_either():
    """Where trials are missing, scenes are sums of parts of seeds."""
    effect = record({CORRECT: (90, 0, 8)}).effects[0]
    above, below = np.nextafter(90.0, 100.0), np.nextafter(10.0, 0.0)
    for rates in ((90.0, above), (above, above), (below, below)):
        assert effect.model_copy(update={"rates": rates}).extreme is None


def test_a_condition_on_which_the_fault_never_acted_is_no_part_of_the_family():
    cells = {CORRECT: (50, 9, 1), "a": (40, 20, 2), SHARED: (40, 2, 20)}
    made = record(cells, altered={"a": 0})
    idle = made.effects[1]
    assert not idle.acted
    assert not idle.significant
    assert idle.corrected_p is None
    assert made.testing.hypotheses == 2
    assert made.changes == ()
    assert [each.condition for each in made.break_even] == [SHARED]


def test_the_primary_contrast_is_the_shared_condition_or_the_only_isolated_one_or_the_one_named():
    level = (50, 5, 5)
    assert three(level, level, level).facts.primary == SHARED
    assert record({CORRECT: level, "observer": level}).facts.primary == "observer"
    assert three(level, level, level, primary="observer").facts.primary == "observer"
    with pytest.raises(UserError, match=r"no condition 'obs'.*has correct, observer, shared"):
        three(level, level, level, primary="obs")
