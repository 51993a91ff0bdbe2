"""Every combination of decisions gets a headline and a conclusion that are true and short."""

import re
from collections.abc import Iterator
from functools import cache
from itertools import product

from outcome_tables import BASELINE, MOST_WORDS, REPAIR, record, sequential

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import CORRECT, SHARED, AuditResult, where
from faultpath.report.sentences.answers import answers
from faultpath.report.sentences.headline import headline

State = tuple[int, str]
"""Who is decided to be ahead, and what is special: `floor`, `idle`, `small`."""
OPEN, GAIN, LOSS = (0, ""), (1, ""), (-1, "")
FLOOR, WON_AT_THE_FLOOR, IDLE, SMALL = (0, "floor"), (1, "floor"), (0, "idle"), (0, "small")
PLAIN = (OPEN, GAIN, LOSS)
SIDES = {REPAIR: 1, BASELINE: -1}


@cache
def four() -> AuditResult:
    return record(dict.fromkeys((CORRECT, "a", "b", SHARED), (50, 5, 5)))


def made(states: dict[str, State], primary: str, turned: str = "") -> AuditResult:
    """Return a record with these decisions; at the module `turned` an interaction is detected."""
    undecided, effects = four(), list[Effect]()
    for effect in undecided.effects:
        if effect.condition in states:
            sign, special = states[effect.condition]
            rates = (5.0, 6.0) if special == "floor" else (55.0, 55.0 + 20.0 * sign)
            corrected = None if special == "idle" else effect.corrected_p
            update = {"sign": sign, "corrected_p": corrected, "rates": rates}
            effects.append(effect.model_copy(update=update))
    changes = [
        change.model_copy(update={"turn": turn(states, change.isolated, turned)})
        for change in undecided.changes
        if change.isolated in states
        and SHARED in states
        and IDLE not in (states[change.isolated], states[SHARED])
    ]
    question = undecided.question
    facts = undecided.facts.model_copy(update={"primary": primary, "trained": True})
    small = tuple(condition for condition, state in states.items() if state == SMALL)
    if small:
        question = question.model_copy(update={"stop_when": "decided", "margin_pp": 5.0})
        facts = facts.model_copy(update={"order": sequential()})
    held = {"scenes": 100, "reached": True, "small": small}
    update = {
        "conditions": tuple(of for of in undecided.conditions if of.name in states),
        "counts": tuple(of for of in undecided.counts if of.condition in states),
        "effects": tuple(effects),
        "changes": tuple(changes),
    }
    update |= {"question": question, "facts": facts}
    partial = undecided.model_copy(update=update | {"break_evens": ()})
    if small:
        partial = AuditResult.model_validate(partial.model_dump() | {"stopped": held})
    return partial


def turn(states: dict[str, State], isolated: str, turned: str) -> str:
    if states[isolated][0] * states[SHARED][0] < 0:
        return "reversal"
    return "interaction" if turned == isolated else "none"


def combinations() -> Iterator[AuditResult]:
    """Yield all that three or four conditions can be decided to be, with every primary contrast."""
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


def holds(said: str, it: AuditResult) -> None:
    """Check each clause of a headline against the decisions."""
    of = {effect.condition: effect for effect in it.effects}
    leads = {condition: effect.sign for condition, effect in of.items() if effect.leads}
    for who, sign in SIDES.items():
        others = [condition for condition, side in leads.items() if side == sign]
        for found in re.finditer(rf"(?<!of )\b{who} ((?:is ahead|with)[^;,.]*)[;,.]", said):
            clause = found[1]
            for condition in places(clause, list(of)):
                assert leads.get(condition) == sign, said
            if "under every condition" in clause and "is ahead" in found[0]:
                assert len(others) == len(of), said
    for found in re.finditer(r"[Nn]o difference([^.;]*)", said):
        assert all(not of[condition].significant for condition in places(found[1], list(of))), said
    if "significant under any condition" in said:
        assert not any(effect.significant for effect in of.values())
    shared = of.get(SHARED)
    open_ = shared and shared.acted and not (shared.sign or shared.extreme)
    if open_ and f"{REPAIR} is ahead" in said and set(leads.values()) == {1}:
        assert "under the shared fault" in said.lower(), said
    if "Do not choose" in said:
        alone = {sign for condition, sign in leads.items() if condition not in (CORRECT, SHARED)}
        assert -leads[SHARED] in alone


def places(clause: str, conditions: list[str]) -> Iterator[str]:
    alone = re.search(r"with only the ((?:\w+)(?: or the \w+)*) faulted", clause)
    yield from alone[1].split(" or the ") if alone else ()
    yield from (
        condition
        for condition in (CORRECT, SHARED)
        if condition in conditions and where(condition) in clause
    )
    if "with it shared" in clause:
        yield SHARED


def test_every_headline_is_short_and_true() -> None:
    seen = 0
    for it in combinations():
        said, seen = headline(it), seen + 1
        assert len(said.split()) <= MOST_WORDS, said
        assert said.endswith("."), said
        assert "trained" not in said
        assert "interaction" not in said
        holds(said, it)
    assert seen > 1500


def test_what_follows_says_who_is_ahead_where_and_what_sharing_does() -> None:
    for correct, isolated, shared, turned in product(PLAIN, PLAIN, PLAIN, ("", "a")):
        states = {CORRECT: correct, "a": isolated, SHARED: shared}
        follows = answers(made(states, SHARED, turned))["What follows"]
        signs = {sign for sign, _ in states.values()} - {0}
        for who, sign in SIDES.items():
            assert (f"{who} succeeds more often" in follows) == (sign in signs)
        reverses = isolated[0] * shared[0] < 0
        assert ("Ask which fault" in follows) == reverses
        stands = turned != "a" or reverses
        assert ("does not stand for the shared one" in follows) == (not stands)
        unseen = isolated != OPEN and shared == OPEN
        assert ("When the fault is shared, no difference is significant." in follows) == unseen
        assert ("depends on which fault occurs" in follows) == (len(signs) == 2 and not reverses)
    for shared in (FLOOR, IDLE, WON_AT_THE_FLOOR):
        it = made({CORRECT: OPEN, "a": GAIN, "b": OPEN, SHARED: shared}, SHARED)
        follows = answers(it)["What follows"]
        assert "With the fault at the a alone, new succeeds more often." in follows
        assert "When the fault is shared" not in follows
