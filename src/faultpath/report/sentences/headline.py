"""The headline: one sentence of some twenty words, by the kind of result.

Names of modules and variants count as one word each.
"""

from collections.abc import Sequence
from typing import TypeAlias

from faultpath.analyses.effects import Effect
from faultpath.analyses.model import CORRECT, SHARED, AuditResult, where
from faultpath.core.text import capital, counted
from faultpath.report.sentences.phrases import (
    NO_RESULT,
    failed_more,
    margin,
    no_pair,
    places,
)

_FEW_DIFFER = 10
"""With fewer scenes that differ, a headline says how many there are."""


def headline(result: AuditResult) -> str:
    """Return a sentence that rests on significant effects, led by the primary contrast, and in how
    many scenes they show where these are few."""
    if result.invalid:
        return NO_RESULT[result.invalid]
    primary, unit = result.facts.primary, result.facts.unit
    main = result.effect(primary)
    tested = [effect for effect in result.effects if effect.acted]
    if main is None:
        return f"{no_pair(primary)}."
    if result.few:
        return (
            f"Too few {unit}s: {result.scenes} compared, and no difference can be significant with "
            f"fewer than {result.testing.scenes_needed}."
        )
    if not main.acted and all(effect.condition == CORRECT for effect in tested):
        return "The fault never changed a reading: no effect of it was tested."
    if not main.acted:
        return f"{capital(where(primary))}, the fault never acted: nothing was tested there."
    ends = {rate for effect in tested for rate in effect.rates}
    if ends <= {0.0, 100.0} and not any(any(map(any, effect.won)) for effect in tested):
        endings = [word for end, word in ((100.0, "succeed"), (0.0, "fail")) if end in ends]
        which = f"every {unit}{' that ran in both,' if any(of.void for of in tested) else ''}"
        return f"No difference could show: in {which} both versions {' or both '.join(endings)}."
    if reversals := reversed_at(result):
        text, named = _reversal(result, main, reversals)
    else:
        text, named = _ranking(result, main, [effect for effect in tested if effect is not main])
    return f"{text[:-1]}{_few_scenes(named, unit)}."


Sentence: TypeAlias = tuple[str, Sequence[Effect]]
"""A sentence, and the effects that it speaks of."""


def _few_scenes(named: Sequence[Effect], unit: str) -> str:
    """Return in how few scenes the versions differ, of the effects that lead; else nothing."""
    few = [effect for effect in named if effect.leads and sum(effect.ahead) < _FEW_DIFFER]
    if not few:
        return ""
    least = sorted(min(few, key=lambda effect: sum(effect.ahead)).ahead)
    equal = [effect for effect in few if sorted(effect.ahead) == least]
    at = f"{where(equal[0].condition)} " if len(named) > 1 else ""
    if len(equal) > 1:
        at = f"under {len(equal)} of these conditions " if len(equal) < len(named) else ""
    less, more = least
    scenes = counted(more, unit) + (" each" if len(equal) > 1 else "")
    never = "never the other way" if not less else f"the other way in {less}"
    return f" ({at}in {scenes}, {never})"


def reversed_at(result: AuditResult) -> list[Effect]:
    """Return the isolated effects that sharing reverses, where advice may rest on both."""
    leading = {effect.condition: effect for effect in result.effects if effect.leads}
    return [
        leading[change.isolated]
        for change in result.changes
        if change.turn == "reversal" and change.isolated in leading and SHARED in leading
    ]


def _reversal(result: AuditResult, main: Effect, reversals: Sequence[Effect]) -> Sentence:
    """Advise against the isolated fault, unless correct inputs rank the versions as it does: then
    a test with it shows no more than one without."""
    one, other = result.winner(reversals[0].sign), result.winner(-reversals[0].sign)
    modules = " or ".join(effect.condition for effect in reversals)
    alone = f"the {modules} alone" if len(reversals) < 3 else "one module alone"
    shared = [effect for effect in result.effects if effect.condition == SHARED]
    correct = [e for e in result.effects if e.condition == CORRECT and e.leads]
    if correct and correct[0].sign == reversals[0].sign:
        with_it = main.condition == SHARED or main in reversals
        at = f" and with it at {alone}" if with_it else ""
        text = f"{one} is ahead without the fault{at}, {other} with it shared."
        return text, [*correct, *(reversals if with_it else ()), *shared]
    advice = f"Do not choose by the fault at {alone}:"
    if main.condition == CORRECT and main.leads and len(reversals) == 1:
        ahead = f"{result.winner(main.sign)} is ahead {where(CORRECT)}."
        text = f"{ahead} {advice} sharing reverses the ranking."
        return text, [main, *reversals, *shared]
    return f"{advice} {one} is ahead there, {other} with it shared.", [*reversals, *shared]


def _ranking(result: AuditResult, main: Effect, others: Sequence[Effect]) -> Sentence:
    """Say who is ahead in the primary contrast, and one thing more.

    That is the shared fault where it shows something else, so that no gain in isolation stands
    without what came of it; or else who is ahead elsewhere, if it is one version in a place or two.
    """
    state = _state(result, main)
    alike = [effect for effect in others if _state(result, effect) == state]
    alike.sort(key=lambda effect: effect.condition != SHARED)
    ahead = [effect for effect in others if effect.leads and effect not in alike]
    shared = [effect for effect in others if effect.condition == SHARED]
    if len(alike) + 1 == len(result.titles) > 1:  # the same everywhere
        return _sentence(result, [main, *alike], everywhere=True)
    if shared and shared[0] not in alike:
        return _sentence(result, [main], shared, both=main.leads)
    if not ahead:
        named = alike if len(alike) < 3 else shared
        return _sentence(result, [main, *named], both=len(named) < 2)
    # Only so many places fit into the words that a headline may have.
    named = [main, *shared]
    count = len(named) + len(ahead)
    most = 3 if main.leads or main.extreme or state == _OPEN else 2
    one_variant = len({effect.sign for effect in ahead}) == 1
    if one_variant and count <= most and main.condition in (CORRECT, SHARED):
        return _sentence(result, named, ahead, both=count == 2)
    return _sentence(result, named, both=False)


def _sentence(
    result: AuditResult,
    first: Sequence[Effect],
    second: Sequence[Effect] = (),
    *,
    both: bool = True,
    everywhere: bool = False,
) -> Sentence:
    """Return a sentence with a clause for each of two groups of like effects.

    `both` names both versions in the first one; `everywhere`: it holds under every condition.
    """
    question, state = result.question, _state(result, first[0])
    where_it_holds = places(first)
    if everywhere:
        where_it_holds = f"under {'any' if state == _OPEN else 'every'} condition"
    if both and first[0].leads:
        state += f" of {result.winner(-first[0].sign)}"
    elif both and state == _OPEN:
        state = f"no difference between {question.baseline} and {question.repair} is significant"
    text = f"{state} {where_it_holds}"
    if second:
        text += f"; {_state(result, second[0])} {places(second)}"
    return f"{text if first[0].leads else capital(text)}.", [*first, *second]


_OPEN = "no difference is significant"


def _state(result: AuditResult, effect: Effect) -> str:
    """Return the result under one condition, as a clause that does not name the condition."""
    if effect.leads:
        return f"{result.winner(effect.sign)} is ahead"
    if effect.extreme:
        return f"both nearly always {'fail' if effect.extreme == 'floor' else 'succeed'}"
    if effect.unsettled:
        return "failed trials leave it open"
    if effect.sign and effect.uneven:
        return failed_more(result, effect)
    if result.is_small(effect):
        return f"the difference is below {margin(result)}"
    return _OPEN
