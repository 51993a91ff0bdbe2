"""What a record says, case by case, as it was approved."""

import pytest
from outcome_tables import (
    REPAIR,
    conditions,
    facts,
    question,
    record,
    sequential,
    table,
    three,
)

from faultpath.analyses.decide import decide
from faultpath.analyses.facts import EarlierAnalysis
from faultpath.analyses.model import CORRECT, SHARED, AuditResult
from faultpath.core.errors import UserError
from faultpath.report.sentences import words
from faultpath.report.sentences.answers import answers
from faultpath.report.sentences.phrases import ahead, change, estimand, in_short

LEVEL, GAIN, LOSS = (50, 5, 5), (40, 30, 2), (40, 2, 30)
TRAININGS = [(40, 30, 2), (42, 28, 3), (38, 31, 1), (39, 30, 2), (41, 29, 0)]
COST, PAID = (50, 0, 16), (30, 24, 0)
FEW = {CORRECT: (0, 3, 0), "a": (0, 3, 0), "b": (0, 3, 0), SHARED: (0, 0, 3)}
UNDETECTED = {CORRECT: (50, 3, 3), "a": GAIN, "b": (50, 3, 3), SHARED: (60, 1, 7)}

CASES = {
    "reversal": lambda: three((50, 0, 0), GAIN, LOSS),
    "reversal, the other way": lambda: three((50, 0, 0), LOSS, GAIN),
    "isolated as without the fault": lambda: three(LOSS, LOSS, GAIN),
    "gain everywhere": lambda: three(GAIN, GAIN, GAIN),
    "nothing anywhere": lambda: three(LEVEL, LEVEL, LEVEL),
    "gain with the fault": lambda: three(LEVEL, GAIN, GAIN),
    "gain with the fault, loss without": lambda: three(LOSS, GAIN, GAIN),
    "loss without the fault": lambda: three(LOSS, LEVEL, LEVEL),
    "gain at the floor": lambda: three(GAIN, GAIN, (0, 9, 0)),
    "no success at all": lambda: three((0, 0, 0), (0, 0, 0), (0, 0, 0)),
    "ties": lambda: three((0, 50, 50), (0, 50, 50), (0, 50, 50)),
    "few scenes": lambda: record(FEW, n=3),
    "an interval that leaves out 0": lambda: record(UNDETECTED),
    "cost and gain": lambda: three(COST, PAID, PAID),
    "gain at every frequency": lambda: three((50, 20, 0), (30, 20, 0), (30, 20, 0)),
    "cost not detected": lambda: three((50, 6, 1), (30, 30, 0), (30, 30, 0)),
    "a fault that never acted": lambda: three(GAIN, GAIN, GAIN, altered={"observer": 0, SHARED: 0}),
    "a fault that acted where it is shared": lambda: three(
        GAIN, GAIN, GAIN, altered={"observer": 0}
    ),
    "a fault that rarely acted": lambda: three(GAIN, GAIN, GAIN, altered={"observer": 30}),
    "trained models": lambda: three(LEVEL, GAIN, LOSS, trained=True),
    "newly trained models": lambda: record(
        {CORRECT: TRAININGS, "observer": TRAININGS}, trained=True, generalise="models"
    ),
    "seeds that change nothing": lambda: record({CORRECT: [GAIN] * 3, "observer": [LOSS] * 3}),
    "every repair failed with the fault": lambda: record(
        {CORRECT: (40, 20, 10), "observer": (20, 10, 30)},
        fails=lambda row: (row.variant, row.condition) == (REPAIR, "observer"),
    ),
}


def text_of(made: AuditResult) -> str:
    """Return all that is said: headline, answers, remarks, changes, and each effect in short."""
    lines = [words(made).headline, f"Of {estimand(made.question, made.facts)}.", ""]
    lines += [f"{label}: {said}" for label, said in answers(made).items()]
    lines += [
        "",
        *(change(made, of) for of in made.changes),
        *words(made).findings,
        "",
        *words(made).would_change,
    ]
    lines += [f"{effect.condition}: {in_short(made, effect)}" for effect in made.effects]
    lines += [f"{of.condition}, how often: {ahead(made.question, of)}" for of in made.break_even]
    return "\n".join(lines)


@pytest.mark.parametrize("name", CASES)
def test_what_is_said_is_what_was_approved(name, approved) -> None:
    approved(name, text_of(CASES[name]()))


@pytest.mark.parametrize(
    ("isolated", "shared", "scenes"),
    [
        ((60, 0, 9), (70, 0, 9), "in 9 scenes each, never the other way"),
        ((60, 0, 10), (70, 0, 9), "under the shared fault in 9 scenes, never the other way"),
        ((60, 0, 9), LOSS, "with the fault at the observer alone in 9 scenes, never the other way"),
    ],
)
def test_a_headline_says_in_how_few_scenes_its_effects_show(isolated, shared, scenes):
    assert words(three((50, 0, 0), isolated, shared)).headline.endswith(f" ({scenes}).")


def test_a_headline_does_not_name_one_of_several_equal_counts():
    cells = {CORRECT: GAIN, "a": (60, 9, 0), "b": (70, 9, 0), SHARED: GAIN}
    assert words(record(cells)).headline.endswith(
        "(under 2 of these conditions in 9 scenes each, never the other way)."
    )


def test_a_headline_counts_scenes_of_no_effect_that_it_does_not_name():
    """It named the condition where old was ahead, behind a sentence that new is ahead."""
    cells = {CORRECT: GAIN, "a": (60, 0, 9), SHARED: LEVEL}
    made = record(cells, primary=CORRECT)
    assert made.effect("a").leads
    ahead = "new is ahead of old under correct inputs"
    assert words(made).headline == (
        f"{ahead}; no difference is significant under the shared fault."
    )
    few = words(record({**cells, CORRECT: (60, 9, 0)}, primary=CORRECT)).headline
    assert few.startswith(ahead)
    assert few.endswith(" (under correct inputs in 9 scenes, never the other way).")


def test_every_condition_is_not_said_where_one_has_no_pair():
    cells = dict.fromkeys((CORRECT, "a", SHARED), GAIN)
    made = record(cells, fails=lambda row: (row.variant, row.condition) == (REPAIR, "a"))
    assert words(made).headline == (
        "new is ahead of old under the shared fault and under correct inputs."
    )


@pytest.mark.parametrize("end", ["floor", "ceiling"])
def test_that_both_always_end_alike_holds_under_every_condition(end):
    counts = (0, 2, 2) if end == "floor" else (96, 2, 2)
    how = "fail" if end == "floor" else "succeed"
    assert words(three(counts, counts, counts)).headline == (
        f"Both nearly always {how} under every condition."
    )


def test_a_sequential_audit_of_all_effects_is_not_told_to_ask_for_all():
    """The advice was the option with which it had run, where effects were shown to be small."""
    cells = dict.fromkeys((CORRECT, "observer", SHARED), (50, 0, 0))
    about = facts(order=sequential())
    for when, advised in (("all-decided", False), ("decided", True)):
        asked = question(stop_when=when, margin_pp=20.0)
        made = decide(asked, about, conditions(*cells), table(cells))
        assert made.stopped.reached
        assert any("--stop-when" in text for text in words(made).would_change) == advised
        assert in_short(made, made.effects[-1]) == "the two differ by less than 20 pp"
        assert "further from 0" not in answers(made)["How sure"], "it stopped for how little it is"
        assert "The intervals hold for" in answers(made)["How sure"], "nothing is significant"
    gain = dict.fromkeys(cells, GAIN)
    made = decide(question(stop_when="decided"), about, conditions(*gain), table(gain))
    assert "further from 0 than the truth" in answers(made)["How sure"]


def test_an_audit_that_was_sequential_is_not_told_to_be():
    earlier = (EarlierAnalysis(scenes=50, primary=CORRECT),)
    for order, told in ((sequential(), False), (None, True)):
        asked = question(stop_when="decided" if order else None)
        cells = dict.fromkeys((CORRECT, "observer", SHARED), GAIN)
        made = decide(asked, facts(order=order), conditions(*cells), table(cells))
        (text,) = words(made.model_copy(update={"earlier": earlier})).findings
        assert ("--stop-when" in text) == told
        assert text.endswith(".")


def test_trainings_say_nothing_of_a_fault_that_never_acted_and_favour_nobody_in_a_tie():
    tie = [(40, 30, 2), (40, 2, 30), (42, 28, 3), (42, 3, 28), (39, 5, 5)]
    cells = {CORRECT: TRAININGS, "observer": TRAININGS, SHARED: tie}
    made = record(cells, altered={"observer": 0}, trained=True, generalise="models")
    sure = answers(made)["How sure"]
    assert "With the fault at the observer alone" not in sure
    assert (
        "Under the shared fault, each version is ahead in 2 of 5 trainings, neither in 1, p = 1.000"
    ) in sure
    none = [effect.model_copy(update={"per_seed": (0.0,) * 5}) for effect in made.effects]
    sure = answers(made.model_copy(update={"effects": tuple(none)}))["How sure"]
    assert "neither version is ahead in any of 5 trainings, p = 1.000" in sure


def test_a_version_in_which_the_fault_changed_nothing_is_said_so():
    made = three(GAIN, GAIN, GAIN)
    observer = made.conditions[1].model_copy(update={"baseline_readers": ("observer.tap",)})
    both = made.model_copy(update={"conditions": (made.conditions[0], observer)})
    counts = tuple(count for count in made.counts if count.condition != SHARED)
    sure = answers(both.model_copy(update={"counts": counts}))["How sure"]
    assert "the fault changed something in none of 100 trials of old." in sure


@pytest.mark.parametrize("kept", [4, 5])
def test_of_few_trainings_or_of_copies_nothing_is_said_of_new_ones(kept):
    trainings = [(40 - seed, 30 + seed, 2) for seed in range(kept)]
    cells = {CORRECT: [*trainings, *[trainings[0]] * (6 - kept)]}
    if kept < 5:
        with pytest.raises(UserError, match="only 4 of the 6 trainings ran under"):
            record(cells, trained=True, generalise="models")
    else:
        assert record(cells, trained=True, generalise="models").effects


@pytest.mark.parametrize("training", [5, 1])
def test_a_training_that_failed_throughout_under_one_condition_is_left_out_there(training):
    """It ended in a traceback: effects under two conditions had other numbers of trainings."""
    by_seed = [(40 - seed, 30 + seed, 2) for seed in range(6)]
    made = record(
        {CORRECT: by_seed, "observer": by_seed, SHARED: by_seed},
        trained=True,
        fails=lambda row: (row.variant, row.condition, row.seed) == (REPAIR, SHARED, training),
        generalise="models",
    )
    assert [len(effect.per_seed) for effect in made.effects] == [6, 6, 5]
    assert len(made.changes[0].per_seed) == 5
