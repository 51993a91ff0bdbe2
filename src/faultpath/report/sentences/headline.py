"""The headline: one sentence of some twenty words, by the kind of result.

Names of modules and variants count as one word each.
"""

from collections.abc import Sequence

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


def headline(result: AuditResult) -> str:
    """Return a sentence that rests on significant effects, led by the primary contrast, and in how
    many scenes they show where these are few."""
    if result.invalid:
        return NO_RESULT[result.invalid]
    primary = result.facts.primary
    main = result.effect(primary)
    tested = [effect for effect in result.effects if effect.acted]
    if main is None:
        return f"{no_pair(primary)}."
    if result.few:
        return (
            f"Too few scenes: {result.scenes} compared, and no difference can be significant with "
            f"fewer than {result.testing.scenes_needed}."
        )
    if not main.acted and all(effect.condition == CORRECT for effect in tested):
        return "The fault never changed a reading: no effect of it was tested."
    if not main.acted:
        return f"{capital(where(primary))}, the fault never acted: nothing was tested there."
    ends = {rate for effect in tested for rate in effect.rates}
    if ends <= {0.0, 100.0} and not any(any(map(any, effect.won)) for effect in tested):
        endings = [word for end, word in ((100.0, "succeed"), (0.0, "fail")) if end in ends]
        which = "every scene that ran in both," if any(of.void for of in tested) else "every scene"
        return f"No difference could show: in {which} both versions {' or '.join(endings)}."
    reversals = reversed_at(result)
    if reversals:
        text = _reversal(result, main, reversals)
    else:
        text = _ranking(result, main, [effect for effect in tested if effect is not main])
    # How few scenes differ qualifies who is ahead, and nothing else that a headline says.
    return f"{text[:-1]}{_few_scenes(result)}." if " is ahead" in text else text


def _few_scenes(result: AuditResult) -> str:
    """Return in how few scenes the versions differ, of the effects that lead; else nothing."""
    leading = [effect for effect in result.effects if effect.leads]
    few = [effect for effect in leading if effect.few_differ]
    if not few:
        return ""
    least = sorted(min(few, key=lambda effect: sum(effect.ahead)).ahead)
    equal = [effect for effect in few if sorted(effect.ahead) == least]
    at = f"{where(equal[0].condition)} " if len(leading) > 1 else ""
    if len(equal) > 1:
        at = f"under {len(equal)} of these conditions " if len(equal) < len(leading) else ""
    less, more = least
    scenes = counted(more, "scene") + (" each" if len(equal) > 1 else "")
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


def _reversal(result: AuditResult, main: Effect, reversals: Sequence[Effect]) -> str:
    """Advise against the isolated fault, unless correct inputs rank the versions as it does: then
    a test with it shows no more than one without."""
    one, other = result.winner(reversals[0].sign), result.winner(-reversals[0].sign)
    modules = " or ".join(effect.condition for effect in reversals)
    alone = f"the {modules} alone" if len(reversals) < 3 else "one module alone"
    correct = [
        effect.sign for effect in result.effects if effect.condition == CORRECT and effect.leads
    ]
    if reversals[0].sign in correct:
        at = f" and with it at {alone}" if main.condition == SHARED or main in reversals else ""
        return f"{one} is ahead without the fault{at}, {other} with it shared."
    advice = f"Do not choose by the fault at {alone}:"
    if main.condition == CORRECT and main.leads and len(reversals) == 1:
        ahead = f"{result.winner(main.sign)} is ahead {where(CORRECT)}."
        return f"{ahead} {advice} sharing reverses the ranking."
    return f"{advice} {one} is ahead there, {other} with it shared."


def _ranking(result: AuditResult, main: Effect, others: Sequence[Effect]) -> str:
    """Say who is ahead in the primary contrast, and one thing more.

    That is the shared fault where it shows something else, so that no gain in isolation stands
    without what came of it; or else who is ahead elsewhere, if it is one version in a place or two.
    """
    state = _state(result, main)
    alike = [effect for effect in others if _state(result, effect) == state]
    alike.sort(key=lambda effect: effect.condition != SHARED)
    ahead = [effect for effect in others if effect.leads and effect not in alike]
    shared = [effect for effect in others if effect.condition == SHARED]
    if len(alike) + 1 == len(result.effects) > 1:  # the same everywhere
        place = "under every condition" if main.leads else "under any condition"
        return _sentence(result, [main], place=place)
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
    place: str = "",
) -> str:
    """Return a sentence with a clause for each of two groups of like effects.

    `both` names both versions in the first one; `place` stands instead of where it holds.
    """
    question, state = result.question, _state(result, first[0])
    if both and first[0].leads:
        state += f" of {result.winner(-first[0].sign)}"
    elif both and state == _OPEN:
        state = f"no difference between {question.baseline} and {question.repair} is significant"
    text = f"{state} {place or places(first)}"
    if second:
        text += f"; {_state(result, second[0])} {places(second)}"
    return f"{text if first[0].leads else capital(text)}."


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
