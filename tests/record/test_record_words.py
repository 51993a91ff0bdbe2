"""The sentences say what was decided, and read well, case by case."""

import re

import pytest
from outcome_tables import BASELINE, REPAIR, arms, paths, question, record, rows, seeded, three

from faultpath.record import CORRECT, SHARED, DecisionRecord, decide
from faultpath.trials import OutcomeTable

LEVEL = (50, 5, 5)
GAIN = (40, 30, 2)
LOSS = (40, 2, 30)


def _numbers(text: str) -> set[float]:
    return {float(number) for number in re.findall(r"[-+]?\d+(?:\.\d+)?", text)}


def test_a_reversal_is_the_headline_and_says_who_wins_where():
    made = three((50, 0, 0), GAIN, LOSS)
    (change,) = made.changes
    assert change.turn == "reversal"
    assert {28.0, -28.0, -56.0} <= _numbers(change.words)
    assert "with only the observer struck, new succeeds more often" in change.words
    assert "under the shared fault, old does" in change.words
    assert change.words in made.verdict.sentences
    assert made.verdict.headline == (
        "Do not choose by the isolated fault: new is ahead with only the observer struck, old with "
        "the fault shared."
    )


def test_a_reversal_the_other_way_round_names_the_other_side():
    made = three((50, 0, 0), LOSS, GAIN)
    assert "old is ahead with only the observer struck, new with the fault shared." in (
        made.verdict.headline
    )


def test_a_change_without_two_effects_is_an_interaction_and_no_advice():
    """An effect of 0 that becomes one of 28 pp: noticed today, not decided."""
    made = three((50, 0, 0), (50, 9, 9), LOSS)
    (change,) = made.changes
    assert change.turn == "interaction"
    assert change.words.startswith("Interaction detected")
    assert change.words in made.verdict.sentences
    assert made.verdict.headline == "old is ahead of new under the shared fault."


@pytest.mark.parametrize(
    ("isolated", "shared"),
    [(LOSS, LOSS), ((50, 6, 5), (50, 5, 6)), ((48, 6, 2), (50, 2, 6))],
    ids=["same loss", "signs differ by chance", "signs differ, neither detected"],
)
def test_without_a_detected_change_nothing_turns(isolated, shared):
    made = three((50, 0, 0), isolated, shared)
    (change,) = made.changes
    assert change.turn == "none"
    assert change.words.startswith("No change is detected between the effect with only")
    assert "Do not" not in made.verdict.headline


def test_a_fault_without_a_shared_path_has_no_change():
    assert record({CORRECT: LEVEL, "observer": LOSS}).changes == ()


HEADLINES = {
    "everywhere": ((GAIN, GAIN, GAIN), "new is ahead of old on every path."),
    "in places": (
        (LEVEL, GAIN, GAIN),
        "new is ahead of old under the shared fault and with only the observer struck.",
    ),
    "depends": (
        (LOSS, GAIN, GAIN),
        "new is ahead under the shared fault and with only the observer struck; old is ahead under "
        "correct inputs.",
    ),
    "elsewhere only": (
        (LOSS, (50, 8, 8), (50, 8, 8)),
        "Under the shared fault, no difference between old and new is detected; old is ahead under "
        "correct inputs.",
    ),
    "nothing": (
        (LEVEL, LEVEL, LEVEL),
        "No difference between old and new is detected on any path.",
    ),
    "floor": (
        (GAIN, GAIN, (0, 9, 0)),
        "Under the shared fault, both nearly always fail; new is ahead under correct inputs and "
        "with only the observer struck.",
    ),
    "ceiling elsewhere": (
        (LEVEL, (95, 1, 1), LEVEL),
        "No difference between old and new is detected away from the floor and the ceiling.",
    ),
    "always both": (
        ((100, 0, 0), (100, 0, 0), (100, 0, 0)),
        "No difference could show: on every path both arms succeed in every scene.",
    ),
    "never either": (
        ((0, 0, 0), (0, 0, 0), (0, 0, 0)),
        "No difference could show: on every path both arms fail in every scene.",
    ),
    "always or never": (
        ((100, 0, 0), (0, 0, 0), (0, 0, 0)),
        "No difference could show: on every path both arms succeed in every scene or fail in every "
        "scene.",
    ),
}


@pytest.mark.parametrize("case", HEADLINES)
def test_the_headline_of_each_case(case):
    cells, said = HEADLINES[case]
    assert three(*cells).verdict.headline == said


def test_a_reversal_at_the_floor_makes_no_headline():
    """Today's headline names a path on which both arms fail in 93 scenes of 100 and more."""
    made = three((60, 4, 7), (0, 9, 0), LOSS)
    (change,) = made.changes
    assert change.turn == "reversal"
    assert change.words.endswith("this carries no headline.")
    assert made.verdict.headline == "old is ahead of new under the shared fault."
    assert made.break_even[0].words == ""
    (floor,) = (effect for effect in made.effects if effect.path == "observer")
    assert "both arms nearly always fail there (0.0 and 9.0 % success)" in floor.words
    assert any(line.startswith("Easier scenes") for line in made.verdict.would_change)


def test_a_primary_contrast_of_ones_own_leads():
    cells = {CORRECT: LOSS, "observer": GAIN, SHARED: LOSS}
    out = [
        row
        for path, counts in cells.items()
        for variant, statuses in arms(counts).items()
        for row in rows(variant, path, statuses)
    ]
    asked = question().model_copy(update={"primary": CORRECT})
    headline = decide(asked, paths(*cells), OutcomeTable(tuple(out))).verdict.headline
    assert headline.startswith("old is ahead under correct inputs. Do not choose by the")


def _words(made: DecisionRecord, path: str) -> str:
    (effect,) = (e for e in made.effects if e.path == path)
    assert effect.words in made.verdict.sentences
    return effect.words


@pytest.mark.parametrize(("counts", "winner"), [(GAIN, REPAIR), (LOSS, BASELINE)])
def test_a_detected_effect_names_the_winner_its_numbers_and_its_test(counts, winner):
    made = three(LEVEL, counts, LEVEL)
    (effect,) = (e for e in made.effects if e.path == "observer")
    words = _words(made, "observer")
    assert words.startswith(f"With only the observer struck, {winner} succeeds more often (")
    shown = {round(x, 1) for x in (effect.success.value, effect.success.low, effect.success.high)}
    assert shown <= _numbers(words)
    assert "p < 0.001 after Holm" in words


def test_where_nothing_is_detected_the_words_say_what_would_have_been_found():
    made = three(LEVEL, GAIN, GAIN)
    words = _words(made, CORRECT)
    (effect,) = (e for e in made.effects if e.path == CORRECT)
    least = re.search(r"a true one of (\d+) pp would be found with 80 % power", words)
    assert least is not None
    assert effect.findable_pp <= int(least[1]) < effect.findable_pp + 1
    (line,) = (line for line in made.verdict.would_change if "less than 80 % power" in line)
    assert f": {least[1]} pp under correct inputs" in line


def test_no_discordance_is_said():
    assert "both arms succeed in the same scenes" in _words(
        three((60, 0, 0), (60, 0, 0), (60, 0, 0)), CORRECT
    )


def test_three_scenes_decide_nothing_however_clear_they_look():
    """The toy with three scenes advised against choosing by the isolated fault."""
    made = record({CORRECT: (0, 0, 3), "observer": (0, 3, 0), SHARED: (0, 0, 3)}, n=3)
    assert made.scenes_needed == 8
    assert made.verdict.headline == (
        "Too few scenes to decide: 3 compared, and this question needs at least 8."
    )
    assert "nothing is decided (+100.0 pp" in _words(made, "observer")
    assert made.verdict.would_change[0].startswith("More scenes: with 8, ")


@pytest.mark.parametrize(
    ("correct", "fault", "said"),
    [
        ((50, 0, 16), (30, 24, 0), r"old is ahead up to \d+ %, new is ahead from \d+ % on"),
        ((50, 16, 0), (30, 0, 24), r"new is ahead up to \d+ %, old is ahead from \d+ % on"),
        ((50, 20, 0), (30, 20, 0), "new is ahead at every frequency"),
        ((50, 0, 20), (30, 0, 20), "old is ahead at every frequency"),
        ((50, 6, 1), (30, 30, 0), "new is ahead from 1?[0-9] % on|where the fault is frequent"),
    ],
    ids=["above", "below", "always", "never", "cost not detected"],
)
def test_the_fault_frequency_is_said_where_it_is_decided(correct, fault, said):
    made = three(correct, fault, fault)
    (sentence,) = (s for s in made.verdict.sentences if s.startswith("By fault frequency: "))
    assert len(re.findall(said, sentence)) == 2
    assert "with only the observer struck" in sentence
    assert "under the shared fault" in sentence


def test_the_words_on_frequency_agree_with_the_set():
    made = three((50, 0, 16), (30, 24, 0), (30, 24, 0))
    (piece,) = made.break_even[0].result.pieces
    found = re.search(r"up to (\d+) %, new is ahead from (\d+) %", made.break_even[0].words)
    assert found is not None
    assert int(found[1]) <= 100 * piece[0] < int(found[1]) + 1
    assert int(found[2]) - 1 < 100 * piece[1] <= int(found[2])


def test_without_a_detected_end_no_frequency_is_decided():
    made = three(LEVEL, LEVEL, LEVEL)
    assert "No fault frequency is decided at which either arm is ahead." in made.verdict.sentences


def test_a_fault_that_never_acted_was_not_tested():
    """Not: no difference is detected."""

    def made(altered: dict[str, int | None]) -> DecisionRecord:
        out = []
        for path in (CORRECT, "observer", SHARED):
            for variant, statuses in arms(GAIN).items():
                out += rows(variant, path, statuses, altered=altered.get(path))
        return decide(question(), paths(CORRECT, "observer", SHARED), OutcomeTable(tuple(out)))

    never = made({"observer": 0, SHARED: 0})
    assert never.verdict.headline == "The fault never acted: nothing was tested."
    assert _words(never, SHARED) == (
        "Shared, the fault never acted on this path: nothing was tested."
    )
    assert never.break_even == ()
    assert any(line.startswith("A fault that acts") for line in never.verdict.would_change)
    partly = made({"observer": 0})
    assert partly.verdict.headline == (
        "new is ahead of old under the shared fault and under correct inputs."
    )
    rarely = made({"observer": 30})
    assert (
        "With only the observer struck, the fault changed something in only 30 of 100 trials of "
        "new." in rarely.verdict.sentences
    )


def test_results_of_trained_models_are_said_to_be_theirs():
    cells = {CORRECT: [LEVEL] * 1, "observer": [GAIN], SHARED: [LOSS]}
    plain, trained = (seeded(cells, trained=flag) for flag in (False, True))
    assert "model" not in " ".join((plain.verdict.headline, *plain.verdict.sentences))
    assert "model" not in plain.effects[0].success.estimand
    assert trained.verdict.headline == plain.verdict.headline
    assert trained.estimand == "new scenes like these, for these trained models"
    assert "models trained anew may differ" in trained.verdict.sentences[0]


def test_newly_trained_models_need_no_qualification_but_a_caution_with_few():
    by_seed = [(40, 30, 2), (42, 28, 3), (38, 31, 1)]
    cells = {CORRECT: by_seed, "observer": by_seed}
    made = seeded(cells, trained=True, generalise="models")
    assert made.estimand.endswith("models newly trained with other seeds")
    assert "these trained models" not in made.verdict.headline
    assert "Caution: 3 trainings say little about new ones" in " ".join(made.verdict.sentences)
    assert all("t test" in effect.test for effect in made.effects)
    by_number = {n: [(40 - i, 30 + i, 2) for i in range(n)] for n in (9, 10)}
    for number, drawn in by_number.items():
        several = seeded(dict.fromkeys(cells, drawn), trained=True, generalise="models")
        assert ("Caution" in " ".join(several.verdict.sentences)) == (number < 10)


def test_every_record_says_what_it_does_not_speak_of():
    for cells in ((GAIN, GAIN, GAIN), (LEVEL, LEVEL, LEVEL)):
        assert "library" in three(*cells).verdict.would_change[-1]
