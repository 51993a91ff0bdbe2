"""Trials that failed decide nothing, and what they leave open is said."""

from dataclasses import replace

import numpy as np
import pytest
from outcome_tables import BASELINE, REPAIR, SCENES, SPOILS, conditions, facts, question, rows

from faultpath.analyses.decide import decide
from faultpath.analyses.family import decide_conditions
from faultpath.analyses.model import CORRECT, SHARED, AuditResult
from faultpath.report.sentences import words
from faultpath.report.sentences.answers import answers
from faultpath.report.sentences.phrases import in_short
from faultpath.run.trials import Trials
from faultpath.system import Status

YES, NO, FAILED = Status.SUCCESS, Status.CRASH, Status.FAILED
Ends = list[Status]


def audit(
    correct: tuple[Ends, Ends], shared: tuple[Ends, Ends] | None = None, *seeds: tuple[Ends, Ends]
) -> AuditResult:
    """Return the record of ends of repair and baseline, by the rule in force; `seeds` are the ends
    under correct inputs with further seeds."""
    over = [(CORRECT, 0, correct), *((CORRECT, n, each) for n, each in enumerate(seeds, 1))]
    if shared is not None:
        over += [("observer", 0, correct), (SHARED, 0, shared)]
    out = [
        row
        for condition, seed, ends in over
        for variant, statuses in zip((REPAIR, BASELINE), ends, strict=True)
        for row in rows(variant, condition, statuses, seed)
    ]
    about = facts(len(correct[0]), range(1 + len(seeds)))
    names = dict.fromkeys(condition for condition, _, _ in over)
    return decide(question(), about, conditions(*names), Trials.of(out))


def ends(success: np.ndarray, failed: np.ndarray | None = None) -> Ends:
    failed = np.zeros_like(success) if failed is None else failed
    return [FAILED if f else YES if s else NO for s, f in zip(success, failed, strict=True)]


def test_what_hangs_on_one_trial_is_open_and_what_does_not_is_decided():
    """Five wins are decided among 100 scenes, and are not with a sixth scene that could be lost."""
    rest = [*[YES] * 44, *[NO] * 50]
    worse, lost = [*[NO] * 5, *rest, YES], [*[YES] * 5, *rest, FAILED]
    whole = audit(([*[YES] * 5, *rest, YES], worse))
    assert whole.effects[0].sign == 1
    assert whole.effects[0].missing is None
    open_ = audit((lost, worse))
    effect = open_.effects[0]
    assert (effect.sign, effect.unsettled, effect.leads) == (0, True, False)
    assert effect.p_value < 0.05
    said = in_short(open_, effect)
    assert said == "not significant: failed or missing trials could undo the difference"
    assert "failed" in words(open_).headline.lower()
    assert "no difference" not in " ".join((words(open_).headline, said)).lower()
    left_open = answers(open_)["Left open"]
    assert "the trials that ran favour new (+5.1 [1.1, 11.3] pp, p = 0.023" in left_open
    assert "holds if failing has nothing to do with how a trial would have ended" in left_open
    assert (
        "failed trials have to run and come out as the others did, at least 1 of new (the same"
        in left_open
    )
    safe = audit((lost, [*[NO] * 20, *rest[15:], YES]))
    assert safe.effects[0].sign == 1
    assert "new is ahead" in words(safe).headline


def test_how_scenes_with_a_failed_trial_end_is_not_said():
    scene = np.arange(SCENES)
    result = audit((ends(scene >= 0, scene < 30), ends(scene >= 0)))
    assert words(result).headline == (
        "No difference could show: in every scene that ran in both, both versions succeed."
    )


def test_a_failure_on_one_condition_costs_the_others_nothing():
    scene = np.arange(SCENES)
    correct = ends(scene < 90), ends((scene >= 20) & (scene < 95))
    shared = ends(scene >= 0), ends(scene >= 50)
    whole = audit(correct, shared)
    failing = audit(correct, (ends(scene >= 0, scene < 30), ends(scene >= 50)))
    for condition in (CORRECT, "observer"):
        one, two = (
            next(e for e in result.effects if e.condition == condition)
            for result in (whole, failing)
        )
        assert (one.value, one.interval, one.p_value, one.scenes) == (
            two.value,
            two.interval,
            two.p_value,
            two.scenes,
        )
    shared_effect = failing.effects[-1]
    assert (shared_effect.scenes, shared_effect.void) == (70, 30)


def test_no_reversal_rests_on_a_condition_where_one_variant_fails_more_often():
    """Decided even with all that is open against it: who is ahead stands, but carries nothing."""
    stands = ends(np.arange(SCENES) < 90), ends(np.arange(SCENES) < 30)
    fails = ends(np.arange(SCENES) < 20, np.arange(SCENES) >= 92), ends(np.arange(SCENES) < 80)
    result = audit(stands, fails)
    shared = next(effect for effect in result.effects if effect.condition == SHARED)
    assert shared.sign == -1
    assert (shared.uneven, shared.leads) == (True, False)
    assert result.changes[0].turn != "reversal"
    assert "Do not choose" not in words(result).headline


def test_what_is_missing_of_a_seed_that_repeats_another_is_open():
    """The seeds agree in every scene that both have: 16 wins without a loss, p = .00017, where only
    scenes with all seeds count."""
    scene = np.arange(SCENES)
    wins, losses = scene < 16, scene >= 80
    first = ends(wins), ends(losses)
    # Of the second, the repair says nothing of the scenes that it loses, the baseline of others.
    second = ends(wins, losses), ends(losses, (scene >= 40) & (scene < 60))
    result = audit(first, None, second)
    effect = result.effects[0]
    assert len(effect.won) == 2
    assert effect.missing is not None
    assert effect.missing.against_pp < effect.value
    assert effect.sign == 0
    assert effect.ahead == (16, 20)
    assert "new is ahead" not in words(result).headline


def test_a_pair_of_which_both_trials_failed_could_have_gone_either_way():
    """The audit had said that the difference "lies anywhere from +20.0 to +20.0 pp"."""
    scene = np.arange(60)
    neither = scene >= 40
    new, old = scene < 14, (scene >= 14) & (scene < 16)
    result = audit((ends(new, neither), ends(old, neither)))
    effect = result.effects[0]
    assert effect.missing is not None
    assert (effect.missing.against_pp, effect.missing.favour_pp) == pytest.approx(
        (-40 / 3, 160 / 3)
    )
    assert (effect.sign, effect.unsettled, effect.leads) == (0, True, False)
    (said,) = [text for text in words(result).findings if "failed" in text]
    assert "lies anywhere from −13.3 to +53.3 pp" in said


def test_a_seed_that_repeats_another_stays_in_the_mean():
    """Two seeds 16:0 and one 0:31: with one of the two dropped, old was ahead at p = .029."""
    scene = np.arange(60)
    wins, losses = scene < 16, scene >= 29
    first, third = (ends(wins), ends(scene < 0)), (ends(scene < 0), ends(losses))
    effect = audit(first, None, first, third).effects[0]
    assert [won for won, _ in effect.won] == [16, 16, 0]
    assert effect.value == pytest.approx(100 / 180)
    assert effect.sign == 0
    same = audit(first, None, first, first).effects[0]
    assert [won for won, _ in same.won] == [16]


def test_how_many_failures_would_have_to_run_is_what_settles_it():
    """Of 30 scenes the repair's trial failed where the baseline succeeded."""
    scene = np.arange(SCENES)
    new, old, failed = scene < 40, scene >= 60, scene >= 70
    effect = audit((ends(new, failed), ends(old))).effects[0]
    assert effect.unsettled
    needed, of_baseline = effect.missing.reruns
    assert of_baseline == 0
    leads = [
        audit((ends(new[left], failed[left]), ends(old[left]))).effects[0].leads
        for ran in (needed - 1, needed)
        for left in [(scene < 70) | (scene >= 70 + ran)]
    ]
    assert leads == [False, True]


def test_a_seed_that_failed_throughout_has_no_effect_of_its_own():
    scene = np.arange(SCENES)
    won, lost = (ends(scene < 20), ends(scene < 0)), (ends(scene < 20), ends(scene < 0, scene >= 0))
    (effect,) = audit(won, None, lost).effects
    assert effect.per_seed == (20.0,)
    assert effect.won == ((20, 0), (0, 0))


def test_how_many_failures_would_have_to_run_is_the_same_in_any_order():
    """Both versions failed alone in 10 scenes, in 5 of which that could turn a tie into a loss."""
    scene = np.arange(SCENES)
    gone, lost = (scene >= 70) & (scene < 80), scene >= 90
    new, old = (scene < 20) | (scene >= 95), (scene == 20) | (scene == 21) | gone & (scene >= 75)
    orders = [scene, scene[::-1], np.random.default_rng(2).permutation(SCENES)]
    trials = [(ends(new[order], gone[order]), ends(old[order], lost[order])) for order in orders]
    reruns = [audit(pair).effects[0].missing.reruns for pair in trials]
    (count,) = {sum(needed) for needed in reruns}
    assert 1 < count < 10
    swapped = [audit(pair[::-1]).effects[0].missing.reruns for pair in trials]
    assert swapped == [needed[::-1] for needed in reruns]


@pytest.mark.parametrize("sign", [1, -1])
def test_failures_that_could_part_the_trainings_leave_new_ones_open(sign):
    """Against the repair they made the fifth training one like the others, and p smaller."""
    repair, baseline = np.zeros((2, SCENES, 5))
    repair[:12] = 1
    repair[12:24, 4] = 1
    failed = np.zeros((SCENES, 5), np.bool_)
    failed[40:64, 4] = True

    def decided(repair, baseline):
        tested = decide_conditions({CORRECT: (repair, baseline)[::sign]}, models=True)
        effect = tested.effects[CORRECT]
        return effect.test.p_value < 0.05, effect.sign, tested.missing

    seen, said, missing = decided(*(np.where(failed, np.nan, x) for x in (repair, baseline)))
    assert (seen, said) == (True, 0)
    assert decided(repair, np.where(failed, 1, baseline))[:2] == (True, sign)
    assert decided(np.where(failed, 1, repair), baseline)[:2] == (False, 0)
    (reruns,) = missing.reruns.values()
    assert 0 < reruns[0] == reruns[1] < 24


@pytest.mark.parametrize("invalid", ["unrepeatable", "unpaired"])
def test_trials_that_do_not_repeat_or_are_no_pairs_support_nothing(invalid):
    scene = np.arange(SCENES)
    trials = [
        *rows(REPAIR, CORRECT, ends(scene < 80)),
        *rows(BASELINE, CORRECT, ends(scene < 20)),
        *rows(REPAIR, "observer", ends(scene < 20)),
        *rows(BASELINE, "observer", ends(scene < 80)),
        *rows(REPAIR, SHARED, ends(scene < 90)),
        *rows(BASELINE, SHARED, ends(scene < 10)),
    ]
    if invalid == "unpaired":
        last = trials[-1]
        trials[-1] = replace(last, outcome=replace(last.outcome, initial_hash="another"))
    table, over = Trials.of(trials), conditions(CORRECT, "observer", SHARED)
    found = [] if invalid == "unpaired" else [SPOILS[invalid]]
    result = decide(question(), facts(), over, table, found)
    assert result.invalid == invalid
    assert words(result).headline.startswith("No result: ")
    assert not any(item.sign for item in (*result.effects, *result.changes))
    assert not any(item.result.regions for item in (*result.break_even, *result.break_even_beta))
    whole = " ".join((words(result).headline, *words(result).sentences, *answers(result).values()))
    assert "ahead" not in whole
    assert "succeeds more often" not in whole


def mixed(stream: np.random.Generator) -> AuditResult:
    """Return a record of which the repair's trials that end badly without the fault fail."""
    scene = np.arange(SCENES)
    lost, won = stream.random((2, SCENES)) < [[0.35], [0.6]]
    correct = ends(~lost, lost & (stream.random(SCENES) < 0.5)), ends(scene >= 0)
    shared = ends(won), ends(~won & (scene % 3 == 0))
    return audit(correct, shared)


def test_a_break_even_frequency_holds_whatever_failed_trials_would_have_been():
    stream = np.random.default_rng(2)
    for _ in range(5):
        result = mixed(stream)
        (found,) = (each for each in result.break_even if each.condition == SHARED)
        against = {each.condition: each.missing.against_pp for each in result.effects}
        even = -against[CORRECT] / (against[SHARED] - against[CORRECT])
        (region,) = (each for each in found.result.regions if each.sign > 0)
        assert region.low > even
        for share, _, low, _ in found.curve:
            assert low > 0.0 or share <= region.low


def test_break_even_without_open_trials_stays_what_it_was():
    stream = np.random.default_rng(3)
    lost, won = stream.random((2, SCENES)) < [[0.3], [0.6]]
    none, every = np.zeros(SCENES, bool), np.ones(SCENES, bool)
    both = np.arange(SCENES) < 5
    whole = audit((ends(~lost), ends(every)), (ends(won), ends(none)))
    voided = audit((ends(~lost, both), ends(every, both)), (ends(won), ends(none)))
    assert whole.break_even[-1].result.kind == voided.break_even[-1].result.kind == "interval"
    assert words(voided).findings
