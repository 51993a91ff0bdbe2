"""The sentences say what was decided, and read well, case by case."""

import re

import pytest
from outcome_tables import (
    BASELINE,
    REPAIR,
    conditions,
    facts,
    question,
    rows,
    seeded,
    three,
    variants,
)

from faultpath.analyses.decide import decide
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.analyses.record import DecisionRecord
from faultpath.analyses.sentences import phrases
from faultpath.analyses.sentences.phrases import in_short
from faultpath.analyses.sentences.shares import ahead
from faultpath.core.errors import UserError
from faultpath.run import Trials
from faultpath.system import Status

LEVEL = (50, 5, 5)
GAIN = (40, 30, 2)
LOSS = (40, 2, 30)


@pytest.mark.parametrize(("isolated", "shared"), [(GAIN, LOSS), (LOSS, GAIN)])
def test_a_reversal_is_the_headline_and_names_who_is_ahead_where(isolated, shared):
    made = three((50, 0, 0), isolated, shared)
    (change,) = made.changes
    one, other = (REPAIR, BASELINE) if isolated == GAIN else (BASELINE, REPAIR)
    assert change.turn == "reversal"
    said = phrases.change(made, change)
    assert said in made.sentences
    assert f"with the fault at the observer alone, {one} succeeds" in said
    assert f"under the shared fault, {other} does" in said
    assert made.headline == (
        f"Do not choose by the fault at the observer alone: {one} is ahead there, {other} with it "
        "shared."
    )


def test_an_isolated_fault_that_leaves_the_ranking_of_correct_inputs_is_not_the_headline():
    decided = three((40, 2, 30), LOSS, GAIN)
    (change,) = decided.changes
    assert change.turn == "reversal"
    assert "Do not choose" not in decided.headline
    assert decided.headline == (
        f"{BASELINE} is ahead without the fault and with it at the observer alone, {REPAIR} with "
        "it shared."
    )


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ((GAIN, GAIN, GAIN), "new is ahead of old under every condition."),
        (
            (LEVEL, LEVEL, LEVEL),
            "No difference between old and new is significant under any condition.",
        ),
        ((LEVEL, GAIN, GAIN), "under the shared fault and with the fault at the observer alone."),
        ((LOSS, GAIN, GAIN), "; old is ahead under correct inputs."),
        ((LOSS, LEVEL, LEVEL), "is significant under the shared fault"),
        ((GAIN, GAIN, (0, 9, 0)), "Both nearly always fail under the shared fault; new is ahead"),
        (((0, 0, 0),) * 3, "No difference could show"),
    ],
)
def test_the_headline_of_each_case(cells, said):
    assert said in three(*cells).headline


def test_where_nothing_is_detected_the_words_say_what_would_have_been_found():
    made = three(LEVEL, GAIN, GAIN)
    words = " ".join(made.sentences)
    (effect,) = (e for e in made.effects if e.condition == CORRECT)
    least = re.search(
        r"significant under correct inputs; a true one of (\d+) pp would be found in 8 of 10", words
    )
    assert least is not None
    assert effect.least_pp <= int(least[1]) < effect.least_pp + 1


@pytest.mark.parametrize(
    ("correct", "fault", "said"),
    [
        ((50, 0, 16), (30, 24, 0), r"old is ahead up to \d+ %, new is ahead from \d+ % on"),
        ((50, 20, 0), (30, 20, 0), "new is ahead at every frequency"),
        ((50, 6, 1), (30, 30, 0), "new is ahead from 1?[0-9] % on|where the fault is frequent"),
    ],
    ids=["above", "always", "cost not detected"],
)
def test_the_fault_frequency_is_said_where_it_is_decided(correct, fault, said):
    made = three(correct, fault, fault)
    assert [each.condition for each in made.break_even] == ["observer", SHARED]
    assert all(re.search(said, ahead(made.question, each)) for each in made.break_even)


def test_a_fault_that_never_acted_was_not_tested():
    def made(altered: dict[str, int | None]) -> DecisionRecord:
        out = []
        for condition in (CORRECT, "observer", SHARED):
            for variant, statuses in variants(GAIN).items():
                out += rows(variant, condition, statuses, altered=altered.get(condition))
        return decide(question(), facts(), conditions(CORRECT, "observer", SHARED), Trials.of(out))

    never = made({"observer": 0, SHARED: 0})
    assert never.headline == "The fault never changed a reading: no effect of it was tested."
    assert in_short(never, never.effects[-1]) == "the fault never acted: not tested"
    assert never.break_even == ()
    partly = made({"observer": 0})
    assert partly.headline.startswith("new is ahead of old under the shared fault")
    rarely = made({"observer": 30})
    assert (
        "With the fault at the observer alone, the fault changed something in only 30 of 100 "
        "trials of new." in rarely.sentences
    )


def test_results_of_trained_models_are_said_to_be_theirs():
    cells = {CORRECT: [LEVEL] * 1, "observer": [GAIN], SHARED: [LOSS]}
    plain, trained = (seeded(cells, trained=flag) for flag in (False, True))
    assert "model" not in " ".join((plain.headline, *plain.sentences))
    assert "model" not in phrases.estimand(plain.question, plain.facts)
    assert trained.headline == plain.headline
    estimand = phrases.estimand(trained.question, trained.facts)
    assert estimand == "new scenes like these, for these trained models"
    assert "models trained anew may differ" in " ".join(trained.sentences)


def test_what_is_said_of_newly_trained_models_names_its_condition_and_a_sign_test():
    by_seed = [(40, 30, 2), (42, 28, 3), (38, 31, 1), (39, 30, 2), (41, 29, 0)]
    cells = {CORRECT: by_seed, "observer": by_seed}
    made = seeded(cells, trained=True, generalise="models")
    assert phrases.estimand(made.question, made.facts).endswith("newly trained with other seeds")
    assert "these trained models" not in made.headline
    whole = " ".join(made.sentences)
    assert "5 trainings stand for new ones as far as trainings spread evenly" in whole
    assert "Under correct inputs, new is ahead in 5 of 5 trainings, p = 0.062 (sign test" in whole
    assert all("t test" in effect.test for effect in made.effects)


@pytest.mark.parametrize("kept", [4, 5])
def test_of_few_trainings_or_of_copies_nothing_is_said_of_new_ones(kept):
    trainings = [(40 - seed, 30 + seed, 2) for seed in range(kept)]
    by_seed = [*trainings, *[trainings[0]] * (6 - kept)]
    if kept < 5:
        with pytest.raises(UserError, match="only 4 of the 6 trainings ran under"):
            seeded({CORRECT: by_seed}, trained=True, generalise="models")
    else:
        assert seeded({CORRECT: by_seed}, trained=True, generalise="models").effects


@pytest.mark.parametrize("lost", [5, 1])
def test_a_training_that_failed_throughout_under_one_condition_is_left_out_there(lost):
    """It ended in a traceback: effects under two conditions had other numbers of trainings."""
    by_seed = [(40 - seed, 30 + seed, 2) for seed in range(6)]
    cells = {CORRECT: by_seed, "observer": by_seed, SHARED: by_seed}
    trials = [
        row
        for condition, counts in cells.items()
        for seed, count in enumerate(counts)
        for variant, statuses in variants(count).items()
        for row in rows(
            variant,
            condition,
            [Status.FAILED] * 100 if (condition, seed) == (SHARED, lost) else statuses,
            seed=seed,
        )
    ]
    about = facts(100, range(6), trained=True)
    made = decide(question(generalise="models"), about, conditions(*cells), Trials.of(trials))
    assert [len(effect.per_seed) for effect in made.effects] == [6, 6, 5]
    assert len(made.changes[0].per_seed) == 5
