"""The sentences say what the numbers say, in every case that there is."""

import re

import pytest
from outcome_tables import BASELINE, REPAIR, record, three

from faultpath.record import CORRECT, SHARED, DecisionRecord

LEVEL = (50, 5, 5)
GAIN = (40, 30, 2)
LOSS = (40, 2, 30)


def _numbers(text: str) -> set[float]:
    return {float(number) for number in re.findall(r"[-+]?\d+(?:\.\d+)?", text)}


def _favoured(text: str) -> set[str]:
    """Return which of the variants a sentence names."""
    return {name for name in (BASELINE, REPAIR) if re.search(rf"\b{name}\b", text)}


def test_a_reversal_is_the_headline_and_says_who_wins_where():
    made = three((50, 0, 0), GAIN, LOSS)
    (turn,) = made.reversals
    assert turn.reversed
    assert turn.change.value == pytest.approx(-28 - 28)
    assert (turn.isolated, turn.shared) == ("observer", SHARED)
    assert {28.0, -28.0} <= _numbers(turn.words)
    ahead = re.search(r": (\w+) is ahead when only the observer is struck, (\w+) when", turn.words)
    assert ahead is not None
    assert ahead.groups() == (REPAIR, BASELINE)
    assert "isolated" in made.verdict.headline
    headline = re.search(r"observer alone, (\w+) is.*shared, (\w+) is", made.verdict.headline)
    assert headline is not None
    assert headline.groups() == (REPAIR, BASELINE)
    assert turn.words in made.verdict.sentences


def test_a_reversal_the_other_way_round_names_the_other_side():
    (turn,) = three((50, 0, 0), LOSS, GAIN).reversals
    assert turn.reversed
    ahead = re.search(r": (\w+) is ahead when only the observer is struck, (\w+) when", turn.words)
    assert ahead is not None
    assert ahead.groups() == (BASELINE, REPAIR)


def test_a_headline_claims_no_winner_where_none_was_detected():
    made = three((50, 0, 0), (50, 6, 12), GAIN)
    (turn,) = made.reversals
    assert turn.reversed
    (isolated,) = (effect for effect in made.effects if effect.path == "observer")
    assert not isolated.detected
    alone, shared = made.verdict.headline.split(";")
    assert "no difference is detected" in alone
    assert round(isolated.success.value, 1) in _numbers(alone)
    assert _favoured(shared) == {REPAIR}


@pytest.mark.parametrize(
    ("isolated", "shared"),
    [(GAIN, (40, 10, 2)), (LEVEL, LOSS), (LOSS, LOSS), ((50, 6, 5), (50, 5, 6))],
    ids=["smaller gain", "from nothing", "same loss", "signs differ by chance"],
)
def test_without_a_detected_change_of_sign_nothing_is_reversed(isolated, shared):
    made = three((50, 0, 0), isolated, shared)
    (turn,) = made.reversals
    assert not turn.reversed
    assert "does not turn" in turn.words
    assert "isolated" not in made.verdict.headline


def test_a_fault_without_a_shared_path_has_no_reversal():
    assert record({CORRECT: LEVEL, "observer": LOSS}).reversals == ()


@pytest.mark.parametrize(
    ("cells", "parts"),
    [
        ((GAIN, GAIN, GAIN), ["favoured over", "every path"]),
        ((LEVEL, GAIN, GAIN), ["favoured over", "2 of 3 paths", "no path is a loss"]),
        ((LEVEL, LOSS, LOSS), ["not favoured", "loses", "observer", "shared"]),
        ((LOSS, GAIN, GAIN), ["depends", "observer", "shared", "correct inputs"]),
        ((LEVEL, LEVEL, LEVEL), ["No difference", "any path"]),
    ],
    ids=["everywhere", "in places", "loses", "depends", "nothing"],
)
def test_the_headline_names_the_case(cells, parts):
    headline = three(*cells).verdict.headline
    for part in parts:
        assert part in headline
    assert _favoured(headline) == {BASELINE, REPAIR}
    assert headline.endswith(".")


def _effect_sentence(made: DecisionRecord, path: str) -> str:
    (effect,) = (e for e in made.effects if e.path == path)
    assert effect.words in made.verdict.sentences
    return effect.words


@pytest.mark.parametrize(("counts", "winner"), [(GAIN, REPAIR), (LOSS, BASELINE)])
def test_a_detected_effect_names_the_winner_and_its_numbers(counts, winner):
    made = three(LEVEL, counts, LEVEL)
    (effect,) = (e for e in made.effects if e.path == "observer")
    assert effect.detected
    words = _effect_sentence(made, "observer")
    assert _favoured(words) == {winner}
    shown = {round(x, 1) for x in (effect.success.value, effect.success.low, effect.success.high)}
    assert shown <= _numbers(words)
    assert "no difference" not in words


def test_where_nothing_is_detected_the_words_say_what_could_have_been():
    made = three(LEVEL, GAIN, GAIN)
    words = _effect_sentence(made, CORRECT)
    (effect,) = (e for e in made.effects if e.path == CORRECT)
    assert not effect.detected
    assert "no difference is detected" in words
    assert effect.minimum_detectable_pp is not None
    assert round(effect.minimum_detectable_pp) in _numbers(words)
    could = [line for line in made.verdict.would_change if "true difference" in line]
    assert len(could) == 1
    assert round(effect.minimum_detectable_pp) in _numbers(could[0])
    assert "correct inputs" in could[0]


def test_too_few_scenes_to_detect_anything_claims_no_detectable_difference():
    made = record({CORRECT: (2, 1, 0)}, n=3)
    (effect,) = made.effects
    assert effect.minimum_detectable_pp is None
    assert not effect.detected
    assert "no difference is detected" in effect.words
    assert "None" not in effect.words


@pytest.mark.parametrize(
    ("correct", "fault", "said"),
    [
        ((50, 4, 16), (30, 24, 0), "favoured above 33 % fault frequency"),
        ((50, 16, 4), (30, 0, 24), "favoured below 33 % fault frequency"),
        ((50, 20, 0), (30, 20, 0), "always favoured"),
        ((50, 0, 20), (30, 0, 20), "never favoured"),
        ((50, 0, 0), (50, 0, 0), "no difference at any fault frequency"),
    ],
    ids=["above", "below", "always", "never", "no difference"],
)
def test_the_break_even_frequency_is_said_for_each_path(correct, fault, said):
    made = three(correct, fault, fault)
    (sentence,) = (s for s in made.verdict.sentences if said in s)
    assert sentence.count(said) == 2
    assert "observer" in sentence
    assert "shared" in sentence
    assert sentence.startswith(REPAIR)


def test_a_shaky_direction_is_among_what_would_change_the_verdict_and_a_firm_one_is_not():
    made = three((50, 0, 30), (50, 3, 1), (50, 30, 0))
    shaky = [line for line in made.verdict.would_change if "resampled" in line]
    assert any("observer" in line for line in shaky)
    assert not any("shared" in line for line in shaky)
    for line, item in zip(shaky, made.break_even, strict=False):
        assert item.result.shares is not None
        other = 100 * (1 - getattr(item.result.shares, item.result.direction))
        assert round(other) in _numbers(line)


def test_every_record_says_what_it_does_not_speak_of():
    for cells in ((GAIN, GAIN, GAIN), (LEVEL, LEVEL, LEVEL)):
        assert "library" in three(*cells).verdict.would_change[-1]


def test_sentences_are_sentences():
    for cells in ((GAIN, LOSS, GAIN), (LEVEL, LEVEL, LEVEL), (LOSS, GAIN, LOSS)):
        verdict = three(*cells).verdict
        for sentence in (verdict.headline, *verdict.sentences, *verdict.would_change):
            assert sentence[0].isupper() or sentence.startswith(REPAIR)
            assert sentence.endswith(".")
            assert "  " not in sentence
            assert not re.search(r"\bnan\b|None", sentence)
