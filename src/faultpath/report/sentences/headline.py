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


def headline(record: AuditResult) -> str:
    """Return a sentence that rests on significant effects, led by the primary contrast, and in how
    many scenes they show where these are few."""
    if record.invalid:
        return NO_RESULT[record.invalid]
    primary = record.facts.primary
    main = record.effect(primary)
    tested = [effect for effect in record.effects if effect.acted]
    if main is None:
        return f"{no_pair(primary)}."
    if record.few:
        return (
            f"Too few scenes: {record.scenes} compared, and no difference can be significant with "
            f"fewer than {record.testing.scenes_needed}."
        )
    if not main.acted and all(effect.condition == CORRECT for effect in tested):
        return "The fault never changed a reading: no effect of it was tested."
    if not main.acted:
        return f"{capital(where(primary))}, the fault never acted: nothing was tested there."
    ends = {rate for effect in tested for rate in effect.rates}
    if ends <= {0.0, 100.0} and not any(any(map(any, effect.won)) for effect in tested):
        every = [word for end, word in ((100.0, "succeed"), (0.0, "fail")) if end in ends]
        ran = " that ran in both," if any(effect.void for effect in tested) else ""
        return f"No difference could show: in every scene{ran} both versions {' or '.join(every)}."
    turned = reversed_at(record)
    if turned:
        text = _reversal(record, main, turned)
    else:
        text = _ranking(record, main, [effect for effect in tested if effect is not main])
    # How few scenes differ qualifies who is ahead, and nothing else that a headline says.
    return f"{text[:-1]}{_few_scenes(record)}." if " is ahead" in text else text


def _few_scenes(record: AuditResult) -> str:
    """Return in how few scenes the versions differ, of the effects that lead; else nothing."""
    leading = [effect for effect in record.effects if effect.leads]
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


def reversed_at(record: AuditResult) -> list[Effect]:
    """Return the isolated effects that sharing reverses, where advice may rest on both."""
    of = {effect.condition: effect for effect in record.effects if effect.leads}
    return [
        of[change.isolated]
        for change in record.changes
        if change.turn == "reversal" and change.isolated in of and SHARED in of
    ]


def _reversal(record: AuditResult, main: Effect, turned: Sequence[Effect]) -> str:
    """Advise against the isolated fault, unless correct inputs rank the versions as it does: then
    a test with it shows no more than one without."""
    one, other = record.winner(turned[0].sign), record.winner(-turned[0].sign)
    modules = " or ".join(effect.condition for effect in turned)
    alone = f"the {modules} alone" if len(turned) < 3 else "one module alone"
    correct = [
        effect.sign for effect in record.effects if effect.condition == CORRECT and effect.leads
    ]
    if turned[0].sign in correct:
        at = f" and with it at {alone}" if main.condition == SHARED or main in turned else ""
        return f"{one} is ahead without the fault{at}, {other} with it shared."
    advice = f"Do not choose by the fault at {alone}:"
    if main.condition == CORRECT and main.leads and len(turned) == 1:
        ahead = f"{record.winner(main.sign)} is ahead {where(CORRECT)}."
        return f"{ahead} {advice} sharing reverses the ranking."
    return f"{advice} {one} is ahead there, {other} with it shared."


def _ranking(record: AuditResult, main: Effect, others: Sequence[Effect]) -> str:
    """Say who is ahead in the primary contrast, and one thing more.

    That is the shared fault where it shows something else, so that no gain in isolation stands
    without what came of it; or else who is ahead elsewhere, if it is one version in a place or two.
    """
    state = _state(record, main)
    alike = [effect for effect in others if _state(record, effect) == state]
    alike.sort(key=lambda effect: effect.condition != SHARED)
    ahead = [effect for effect in others if effect.leads and effect not in alike]
    shared = [effect for effect in others if effect.condition == SHARED]
    if len(alike) + 1 == len(record.effects) > 1:  # the same everywhere
        place = "under every condition" if main.leads else "under any condition"
        return _sentence(record, [main], place=place)
    if shared and shared[0] not in alike:
        return _sentence(record, [main], shared, both=main.leads)
    if not ahead:
        named = alike if len(alike) < 3 else shared
        return _sentence(record, [main, *named], both=len(named) < 2)
    # Only so many places fit into the words that a headline may have.
    named = [main, *shared]
    count = len(named) + len(ahead)
    most = 3 if main.leads or main.extreme or state == _OPEN else 2
    one_variant = len({effect.sign for effect in ahead}) == 1
    if one_variant and count <= most and main.condition in (CORRECT, SHARED):
        return _sentence(record, named, ahead, both=count == 2)
    return _sentence(record, named, both=False)


def _sentence(
    record: AuditResult,
    first: Sequence[Effect],
    second: Sequence[Effect] = (),
    *,
    both: bool = True,
    place: str = "",
) -> str:
    """Return a sentence with a clause for each of two groups of like effects.

    `both` names both versions in the first one; `place` stands instead of where it holds.
    """
    question, state = record.question, _state(record, first[0])
    if both and first[0].leads:
        state += f" of {record.winner(-first[0].sign)}"
    elif both and state == _OPEN:
        state = f"no difference between {question.baseline} and {question.repair} is significant"
    text = f"{state} {place or places(first)}"
    if second:
        text += f"; {_state(record, second[0])} {places(second)}"
    return f"{text if first[0].leads else capital(text)}."


_OPEN = "no difference is significant"


def _state(record: AuditResult, effect: Effect) -> str:
    """Return the result under one condition, as a clause that does not name the condition."""
    if effect.leads:
        return f"{record.winner(effect.sign)} is ahead"
    if effect.extreme:
        return f"both nearly always {'fail' if effect.extreme == 'floor' else 'succeed'}"
    if effect.unsettled:
        return "failed trials leave it open"
    if effect.sign and effect.uneven:
        return failed_more(record, effect)
    if record.is_small(effect):
        return f"the difference is below {margin(record)}"
    return _OPEN
