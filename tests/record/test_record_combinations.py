"""Every combination of decisions gets a headline and a conclusion that are true and short."""

import re
from collections.abc import Iterator
from itertools import product

import pytest
from outcome_tables import BASELINE, REPAIR, record

from faultpath.record import CORRECT, SHARED, DecisionRecord
from faultpath.record.headline import MOST_WORDS, headline
from faultpath.record.model import Change, Effect
from faultpath.record.plain import about, decided_words, not_standing, plain_words
from faultpath.record.question import StopRule
from faultpath.record.words import effect_words, where

State = tuple[int, str]
"""Who is decided to be ahead, and what is special: `floor`, `idle`, `small`."""
OPEN, GAIN, LOSS = (0, ""), (1, ""), (-1, "")
FLOOR, WON_AT_THE_FLOOR, IDLE, SMALL = (0, "floor"), (1, "floor"), (0, "idle"), (0, "small")
PLAIN = (OPEN, GAIN, LOSS)
SIDES = {REPAIR: 1, BASELINE: -1}
FOUR = record(dict.fromkeys((CORRECT, "a", "b", SHARED), (50, 5, 5)))


def made(states: dict[str, State], primary: str, turned: str = "") -> DecisionRecord:
    """Return a record with these decisions; at the module `turned` an interaction is detected."""
    effects: list[Effect] = []
    for effect in FOUR.effects:
        if effect.path in states:
            sign, special = states[effect.path]
            rates = (5.0, 6.0) if special == "floor" else (55.0, 55.0 + 20.0 * sign)
            update = {
                "sign": sign,
                "extreme": "floor" if special == "floor" else None,
                "acted": special != "idle",
                "baseline_percent": rates[0],
                "repair_percent": rates[1],
            }
            effects.append(effect.model_copy(update=update))
    changes = [
        change.model_copy(update={"turn": turn(states, change.isolated, turned)})
        for change in FOUR.changes
        if change.isolated in states
        and SHARED in states
        and IDLE not in (states[change.isolated], states[SHARED])
    ]
    question = FOUR.question.model_copy(update={"primary": primary, "trained": True})
    small = tuple(path for path, state in states.items() if state == SMALL)
    if small:
        rule = StopRule(when="decided", margin_pp=5.0, order=(), order_seed=0, look=5, trials=8)
        question = question.model_copy(update={"stop": rule})
    held = {"scenes": 100, "reached": True, "small": small}
    update = {"question": question, "effects": tuple(effects), "changes": tuple(changes)}
    partial = FOUR.model_copy(update=update | {"break_even": ()})
    if small:
        partial = DecisionRecord.model_validate(partial.model_dump() | {"stopped": held})
    told = headline(about(partial), effects, changes)
    verdict = partial.verdict.model_copy(update={"headline": told})
    return partial.model_copy(update={"verdict": verdict})


def turn(states: dict[str, State], isolated: str, turned: str) -> str:
    if states[isolated][0] * states[SHARED][0] < 0:
        return "reversal"
    return "interaction" if turned == isolated else "none"


def combinations() -> Iterator[DecisionRecord]:
    """Yield all that three or four paths can be decided to be, with every primary contrast."""
    special = (*PLAIN, FLOOR, WON_AT_THE_FLOOR, IDLE, SMALL)
    for correct, a, shared in product((*PLAIN, FLOOR), special, special):
        for primary in (CORRECT, "a", SHARED):
            states = {CORRECT: correct, "a": a, SHARED: shared}
            yield from (made(states, primary, turned) for turned in ("", "a"))
    for correct, a, b, shared in product(PLAIN, (*PLAIN, FLOOR), PLAIN, (*PLAIN, FLOOR)):
        for primary in (CORRECT, "a", "b", SHARED):
            yield made({CORRECT: correct, "a": a, "b": b, SHARED: shared}, primary)
    for correct, a in product(PLAIN, special):
        yield from (made({CORRECT: correct, "a": a}, primary) for primary in (CORRECT, "a"))


def holds(said: str, it: DecisionRecord) -> None:
    """Check each clause of a headline against the decisions."""
    of = {effect.path: effect for effect in it.effects}
    leads = {path: effect.sign for path, effect in of.items() if effect.leads}
    for who, sign in SIDES.items():
        others = [path for path, side in leads.items() if side == sign]
        for found in re.finditer(rf"(?<!of )(?<!and )\b{who} (?:is ahead)?([^;,.]*)[;,.]", said):
            clause = found[1]
            for path in places(clause, list(of)):
                assert leads.get(path) == sign, said
            if count := re.search(r"on (\d+)", clause):
                assert int(count[1]) == len(set(others) - {it.question.primary}), said
            if "on every path" in clause and "is ahead" in found[0]:
                assert len(others) == len(of), said
    for found in re.finditer(r"([^.;,]*), no difference", said):
        assert all(not of[path].detected for path in places(found[1], list(of))), said
    if "detected on any path" in said:
        assert not any(effect.detected for effect in of.values())
    shared = of.get(SHARED)
    open_ = shared and shared.acted and not (shared.sign or shared.extreme)
    if open_ and f"{REPAIR} is ahead" in said and set(leads.values()) == {1}:
        assert "under the shared fault" in said.lower(), said
    if "Do not choose" in said:
        alone = {sign for path, sign in leads.items() if path not in (CORRECT, SHARED)}
        assert -leads[SHARED] in alone


def places(clause: str, paths: list[str]) -> Iterator[str]:
    """Yield the paths that a clause names."""
    alone = re.search(r"with only the ((?:\w+)(?: or the \w+)*) struck", clause)
    yield from alone[1].split(" or the ") if alone else ()
    yield from (path for path in (CORRECT, SHARED) if path in paths and where(path) in clause)
    if "with the fault shared" in clause:
        yield SHARED


def test_every_headline_is_short_and_true() -> None:
    seen = 0
    for it in combinations():
        said, seen = it.verdict.headline, seen + 1
        assert len(said.split()) <= MOST_WORDS, said
        assert said.endswith("."), said
        assert "trained" not in said
        assert "interaction" not in said
        holds(said, it)
    assert seen > 1500


CONCLUSIONS: dict[tuple[State, State], str] = {
    (OPEN, OPEN): "",
    (OPEN, GAIN): "The gain seen when the fault is shared is not seen in isolation.",
    (OPEN, LOSS): "The loss seen when the fault is shared is not seen in isolation.",
    (GAIN, OPEN): "The gain seen in isolation is not seen when the fault is shared.",
    (GAIN, GAIN): "With only the a struck and under the shared fault, new succeeds more often.",
    (GAIN, LOSS): (
        "Ask which fault your system will meet: with only the a struck, new succeeds more often; "
        "where the modules share it, old succeeds more often."
    ),
    (LOSS, OPEN): "The loss seen in isolation is not seen when the fault is shared.",
    (LOSS, GAIN): (
        "Ask which fault your system will meet: with only the a struck, old succeeds more often; "
        "where the modules share it, new succeeds more often."
    ),
    (LOSS, LOSS): "With only the a struck and under the shared fault, old succeeds more often.",
}
"""By what is decided in isolation and when shared: what follows of the fault."""
BESIDE = {1: "Under correct inputs, new", -1: "Under correct inputs, old"}
CHANGED = "A fault at the a alone does not stand for the shared one"


@pytest.mark.parametrize("correct", PLAIN)
@pytest.mark.parametrize("turned", ["", "a"])
@pytest.mark.parametrize(("isolated", "shared"), CONCLUSIONS)
def test_each_combination_of_decisions_has_its_conclusion(
    isolated: State, shared: State, turned: str, correct: State
) -> None:
    it = made({CORRECT: correct, "a": isolated, SHARED: shared}, SHARED, turned)
    follows = plain_words(it)["What follows"]
    said = CONCLUSIONS[isolated, shared]
    assert follows.startswith(said or ("Nothing that was" if correct == OPEN else "Only under"))
    assert (CHANGED in follows) == (turned == "a" and isolated[0] * shared[0] >= 0)
    sides = {isolated[0], shared[0], correct[0]} - {0}
    if said and correct != OPEN:
        assert f"{BESIDE[correct[0]]} succeeds more often." in follows
    disagree = len(sides) == 2 and "Ask which" not in follows
    assert ("the paths disagree" in follows) == disagree
    assert "in favour of" not in follows


@pytest.mark.parametrize(
    ("a", "b", "shared", "said"),
    [
        (GAIN, GAIN, OPEN, "The gain seen in isolation is not seen when the fault is shared."),
        (GAIN, OPEN, OPEN, "The gain seen in isolation is not seen when the fault is shared."),
        (GAIN, LOSS, OPEN, "When the fault is shared, no difference is seen."),
        (GAIN, OPEN, FLOOR, "With only the a struck, new succeeds more often."),
        (GAIN, OPEN, IDLE, "With only the a struck, new succeeds more often."),
        (GAIN, OPEN, WON_AT_THE_FLOOR, "With only the a struck, new succeeds more often."),
        (FLOOR, OPEN, GAIN, "Under the shared fault, new succeeds more often."),
        (GAIN, LOSS, GAIN, "Ask which fault your system will meet: with only the b struck, old"),
        (FLOOR, FLOOR, WON_AT_THE_FLOOR, "What is decided lies at the floor or ceiling"),
        (GAIN, OPEN, SMALL, "Under the shared fault, the difference is smaller than 5 pp."),
    ],
)
def test_what_cannot_show_is_not_told_as_unseen(
    a: State, b: State, shared: State, said: str
) -> None:
    follows = plain_words(made({CORRECT: OPEN, "a": a, "b": b, SHARED: shared}, SHARED))[
        "What follows"
    ]
    assert said in follows
    unseen = "not seen" in follows or "no difference is seen" in follows
    assert unseen == (shared in (OPEN, SMALL))


def alone() -> tuple[DecisionRecord, Effect, Change]:
    """Return a record whose shared interval leaves out 0 while Holm's p is too large."""
    it = record({CORRECT: (50, 3, 3), "a": (40, 30, 2), "b": (50, 3, 3), SHARED: (60, 1, 8)})
    return it, it.effects[-1], it.changes[-1]


def test_an_interval_that_leaves_out_0_undetected_has_its_p_and_the_reason() -> None:
    it, shared, _ = alone()
    assert (shared.success.high or 0.0) < 0
    assert not shared.detected
    p = f"p = {shared.adjusted_p_value:.3f} after Holm"
    assert decided_words(about(it), shared) == f"no difference detected ({p})"
    assert f"{p}: the interval alone decides nothing" in effect_words(about(it), shared)
    (said,) = not_standing(it)
    assert said in plain_words(it)["Not decided"]
    assert p in said
    assert f"{it.hypotheses} contrasts" in said
    clear = record({CORRECT: (50, 3, 3), "a": (40, 30, 2), SHARED: (50, 5, 5)})
    assert not list(not_standing(clear))
    assert "decides nothing" not in " ".join(clear.verdict.sentences)
