"""Whatever comes out of a run, no sentence claims what was not decided."""

import re
from collections.abc import Callable, Iterator

import pytest
from outcome_tables import (
    BASELINE,
    MOST_WORDS,
    REPAIR,
    Counts,
    conditions,
    facts,
    question,
    rows,
    sequential,
    variants,
)

from faultpath.analyses.decide import decide
from faultpath.analyses.effects import Change, Effect
from faultpath.analyses.model import CORRECT, SHARED, AuditResult
from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.report.sentences import phrases, wording, words
from faultpath.report.sentences.answers import answers
from faultpath.report.sentences.phrases import ahead, in_short
from faultpath.run.question import StopWhen
from faultpath.run.trials import Trials
from faultpath.system import Status


@pytest.fixture(autouse=True)
def _no_curves(monkeypatch: pytest.MonkeyPatch) -> None:
    """No sentence is of a curve of break-even, and a quarter of the time is spent on them."""
    monkeypatch.setattr("faultpath.analyses.shares.mixture_curve", lambda *_, **__: ())


SIDES = ((REPAIR, 1), (BASELINE, -1))
Statuses = dict[str, list[Status]]
CONDITIONS = {
    "one condition": (CORRECT,),
    "one module": (CORRECT, "a"),
    "shared": (CORRECT, "a", "b", SHARED),
}
YES, NO = Status.SUCCESS, Status.TIMEOUT


COUNTS: dict[str, Callable[[str, int], Counts]] = {
    "always": lambda condition, n: (n, 0, 0),
    "never": lambda condition, n: (0, 0, 0),
    "no discordance": lambda condition, n: (n // 2, 0, 0),
    "ties": lambda condition, n: (0, n // 2, n // 2),
    "for the repair": lambda condition, n: (0, n, 0),
    "against it when shared": lambda condition, n: (0, 0, n) if condition == SHARED else (0, n, 0),
    "against it without a fault": lambda condition, n: (
        (0, 0, n) if condition == CORRECT else (0, n, 0)
    ),
    "near the floor": lambda condition, n: (0, n // 12, 0),
    "near the ceiling": lambda condition, n: (n - n // 12, 0, n // 12),
}


LEANS = {"by chance": {}, "leaning": {CORRECT: -0.1, "a": 0.25, SHARED: -0.3}}
"""Drawn effects: none, and of different size and side by condition, some of them significant."""
SHAPES = (*COUNTS, *LEANS)


def ends_of(shape: str, condition: str, seed: int, n: int) -> Statuses:
    if shape in COUNTS:
        return variants(COUNTS[shape](condition, n), n)
    stream, lean = generator("test/words", condition, seed), LEANS[shape].get(condition, 0.0)
    chances = {REPAIR: 0.5 + lean, BASELINE: 0.5 - lean}
    return {v: [YES if x else NO for x in stream.random(n) < p] for v, p in chances.items()}


RUNS = ("one seed", "three seeds", "identical seeds", "void", "never acted", "one condition idle")
RULES: dict[str, tuple[StopWhen, float | None, int]] = {
    "as soon as decided": ("decided", None, 100),
    "to the last scene": ("decided", 99.0, 0),
    "all": ("all-decided", None, 0),
    "all or small": ("all-decided", 50.0, 100),
}
"""When sequential audits stop, their margins, and how many scenes they may take; 0 for as many as
they did."""


def run(
    shape: str, over: tuple[str, ...], n: int, how: str, trained: bool, rule: str = ""
) -> AuditResult:
    seeds = (0, 1, 2) if "seeds" in how else (0,)
    out = []
    for seed in seeds:
        for condition in over:
            drawn = ends_of(shape, condition, 0 if how == "identical seeds" else seed, n)
            idle = how == "never acted" or (how == "one condition idle" and condition == over[-1])
            for variant, statuses in drawn.items():
                ends = list(statuses)
                if how == "void" and variant == REPAIR and condition == over[-1]:
                    ends[0] = Status.FAILED
                out += rows(variant, condition, ends, seed=seed, altered=0 if idle else None)
    asked, about = question(), facts(n, seeds, trained=trained)
    if rule:
        when, margin, most = RULES[rule]
        asked = question(stop_when=when, margin_pp=margin)
        about = facts(most or n, seeds, trained=trained, order=sequential())
    return decide(asked, about, conditions(*over), Trials.of(out))


def sentences(made: AuditResult) -> Iterator[str]:
    yield words(made).headline
    yield from words(made).sentences
    yield from words(made).would_change or ()
    yield from answers(made).values()


def holm(made: AuditResult, tested: list[Effect | Change]) -> list[float]:
    """Return p-values by Holm's procedure, weighted where the rule is."""
    primary = [isinstance(e, Effect) and e.condition == made.facts.primary for e in tested]
    weighted = any(primary)
    weights = [max(1, len(tested) - 1) if weighted and it else 1 for it in primary]
    order = sorted(range(len(tested)), key=lambda i: tested[i].p_value / weights[i])
    adjusted, worst = [0.0] * len(tested), 0.0
    for rank, i in enumerate(order):
        left = sum(weights[j] for j in order[rank:])
        worst = max(worst, min(1.0, left / weights[i] * tested[i].p_value))
        adjusted[i] = worst
    return adjusted


def shared_out(made: AuditResult, tested: list[Effect | Change]) -> list[float]:
    """Return p-values by the shares of all that a sequential audit could have announced."""
    named = {condition.name for condition in made.conditions}
    others = len(named) - 1 + (len(named - {CORRECT, SHARED}) if SHARED in named else 0)
    adjusted: list[float] = []
    for each in tested:
        primary = isinstance(each, Effect) and each.condition == made.facts.primary
        factor = 1 if not others else 2 if primary else 2 * others
        adjusted.append(min(1.0, factor * each.p_value))
    return adjusted


def may_be_said(made: AuditResult) -> tuple[dict[str, int], dict[str, int]]:
    """Return the signs that the numbers allow, of effects and of changes, worked out anew."""
    tested: list[Effect | Change] = [e for e in made.effects if e.acted]
    tested += made.changes
    signs: list[int] = []
    adjusted = shared_out(made, tested) if made.stopped else holm(made, tested)
    for each, p in zip(tested, adjusted, strict=True):
        assert each.corrected_p == pytest.approx(p)
        shown = each
        low, high = shown.low or 0.0, shown.high or 0.0
        signs.append((low > 0) - (high < 0) if p <= 0.05 and not each.unsettled else 0)
        assert not each.unsettled or any(effect.missing for effect in made.effects)
    of = {e.condition: s for e, s in zip(tested, signs, strict=False) if isinstance(e, Effect)}
    turned = dict(zip([c.isolated for c in made.changes], signs[len(of) :], strict=True))
    return of, turned


def claimed(text: str, who: str) -> bool:
    """Return whether a text says of a variant that it is ahead, anywhere."""
    return bool(re.search(rf"\b{who} (is ahead|succeeds more often|does \(|is(\.| \(for))", text))


def check(made: AuditResult) -> None:
    effects, changes = may_be_said(made)
    whole = " ".join(sentences(made))
    for who, sign in SIDES:
        leading = {effects.get(e.condition) for e in made.effects if e.leads}
        assert (sign in leading) <= claimed(whole, who) <= (sign in effects.values()), whole
        headed = {
            e.condition for e in made.effects if effects.get(e.condition) == sign and not e.extreme
        }
        assert not claimed(words(made).headline, who) or headed
    for change in made.changes:
        opposite = effects[change.isolated] * effects[SHARED] < 0
        said = phrases.change(made, change)
        assert ("reverses" in said) == opposite
        assert ("Significant interaction" in said) == (
            not opposite and changes[change.isolated] != 0
        )
    turned = {c.isolated for c in made.changes if effects[c.isolated] * effects[SHARED] < 0}
    extreme = {e.condition for e in made.effects if e.extreme}
    correct = 0 if CORRECT in extreme else effects[CORRECT]
    misleading = {condition for condition in turned - extreme if effects[condition] != correct}
    assert ("Do not" in whole) == bool(misleading and SHARED not in extreme)
    plain = answers(made)
    advised = "Ask which" in " ".join(plain.values())
    if made.scenes < made.testing.scenes_needed:
        assert list(plain) == ["Left open", "How sure"]
        assert plain["Left open"].startswith("Too few scenes")
        assert not advised
    else:
        assert advised == bool(turned - extreme and SHARED not in extreme)
        follows = plain["What follows"]
        told = {sign for condition, sign in effects.items() if sign and condition not in extreme}
        assert not claimed(follows, REPAIR) or 1 in told
        assert not claimed(follows, BASELINE) or -1 in told
        alone = any(each.turn == "interaction" for each in made.changes)
        assert ("does not stand for the shared one" in follows) == alone
    for effect in made.effects:
        short = in_short(made, effect)
        assert effect.acted or "not tested" in short
        low, high = effect.low or 0.0, effect.high or 0.0
        if effect.unsettled:
            assert "failed" in short
        elif (low > 0 or high < 0) and effect.acted and not effects.get(effect.condition):
            assert made.scenes < made.testing.scenes_needed or f"{effect.corrected_p:.3f}" in short
        for who, side in SIDES:
            assert claimed(short, who) == (effects.get(effect.condition, 0) == side)
    frequencies = [(item, CORRECT, item.condition) for item in made.break_even]
    for item, *at in (*frequencies, *((b, b.condition, SHARED) for b in made.break_even_beta)):
        over = ahead(made.question, item, at[1] == SHARED)
        ends = {effects.get(condition, 0) for condition in at} - {0}
        for who, sign in SIDES:
            assert not claimed(over, who) or sign in ends
        shown = wording.break_even(item.result)
        part = " is ahead where " in over
        assert (shown == "any") == (not over or part), (shown, over)
        assert item.result.level >= 0.95 - 1e-12
    if made.facts.primary not in {e.condition for e in made.effects}:
        assert "no pair of trials is left" in words(made).headline
    elif made.scenes < made.testing.scenes_needed:
        assert words(made).headline.startswith("Too few scenes")
        assert str(made.testing.scenes_needed) in words(made).headline


def reads_well(made: AuditResult) -> None:
    assert len(re.sub(r" \([^()]*\)\.$", "", words(made).headline).split()) <= MOST_WORDS
    for sentence in sentences(made):
        assert sentence[0].isupper() or sentence.startswith((REPAIR, BASELINE))
        assert sentence.endswith(".")
        assert not re.search(r"  |\bnan\b|None|\.\.|,,|\bfly|(always|never) favoured", sentence)
        assert sentence.count("(") == sentence.count(")")


@pytest.mark.parametrize("n", [1, 4, 40])
@pytest.mark.parametrize("how", RUNS)
@pytest.mark.parametrize("over", CONDITIONS)
def test_no_sentence_claims_what_was_not_decided(n: int, how: str, over: str) -> None:
    every = how in ("one seed", "three seeds", "void") or n == 40
    for shape in SHAPES if every else ("ties", *LEANS):
        if how == "void" and n == 1 and len(CONDITIONS[over]) == 1:
            with pytest.raises(UserError, match="no scene is left"):
                run(shape, CONDITIONS[over], n, how, trained=False)
            continue
        made = run(shape, CONDITIONS[over], n, how, trained=n % 3 == 0)
        check(made)
        reads_well(made)


def says_how_it_stopped(made: AuditResult) -> None:
    """Check what is said of stopping, and that nothing is shown that needs a fixed number."""
    held, asked, about = made.stopped, made.question, made.facts
    assert held
    assert about.order
    told = next(s for s in words(made).sentences if s.startswith("This audit was sequential"))
    most = about.n_scenes
    signs = may_be_said(made)[0]
    decided = {condition for condition, sign in signs.items() if sign} | set(held.small)
    wanted = (
        {e.condition for e in made.effects} if asked.stop_when == "all-decided" else {about.primary}
    )
    assert held.reached == (wanted <= decided)
    assert ("it stopped after" in told) == (held.reached and held.scenes < most)
    assert ("all that it was allowed" in told) == (held.scenes == most)
    assert ("not significant" in told or "not every" in told) == (not held.reached)
    assert held.scenes == 1 or "1 scenes" not in told
    for effect, secondary in zip(made.effects, made.secondary, strict=True):
        small = effect.condition in held.small
        assert not small or asked.margin_pp
        low, high = effect.low or 0.0, effect.high or 0.0
        assert not small or max(-low, high) < (asked.margin_pp or 0.0)
        assert effect.least_pp is None
        for other in (secondary.time_s, *secondary.metrics.values()):
            assert other is None or (other.low, other.high) == (None, None)
    assert "differ by less than" not in words(made).headline or about.primary in held.small
    whole = made.model_dump_json()
    for fixed in ("Holm", "80 % power", "McNemar", "sign test", "Tango", "bootstrap", "score"):
        assert fixed not in whole


@pytest.mark.parametrize("n", [1, 4, 40])
@pytest.mark.parametrize("how", ["one seed", "three seeds", "void", "one condition idle"])
@pytest.mark.parametrize("over", ["one condition", "shared"])
def test_no_sentence_of_a_sequential_audit_claims_what_was_not_decided(
    n: int, how: str, over: str
) -> None:
    for shape in SHAPES:
        every = how == "one seed" and (n == 40 or (over == "one condition" and n > 2))
        for rule in RULES if every else ("to the last scene",):
            if how == "void" and n == 1 and len(CONDITIONS[over]) == 1:
                continue
            made = run(shape, CONDITIONS[over], n, how, trained=n % 3 == 0, rule=rule)
            check(made)
            reads_well(made)
            says_how_it_stopped(made)
