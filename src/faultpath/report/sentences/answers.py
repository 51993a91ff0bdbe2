"""Three plain answers: what follows, how sure it is, what stays open.

Whoever reads nothing else reads these, so what qualifies a decision is said here too.
"""

from collections.abc import Iterator

from faultpath.analyses.model import CORRECT, SHARED, AuditResult, Invalid, where
from faultpath.core.text import capital, counted, series
from faultpath.report.sentences import phrases
from faultpath.report.sentences.headline import reversed_at
from faultpath.report.sentences.phrases import margin, places
from faultpath.report.sentences.wording import detectable, signed
from faultpath.report.tables import MISSING

_WHY_NO_RESULT: dict[Invalid, str] = {
    "unrepeatable": "Trials that ran a second time came out otherwise, so every difference may be "
    "chance: see the remark on what differed, fix the system and run it again.",
    "unpaired": "Trials that were to be compared met different conditions, so a difference may be "
    "theirs: see the remark on what differed, fix what draws them and run it again.",
}
_PAIRED = {
    "keys": "Trials are paired by their keys alone: nothing shows that both versions started "
    "alike.",
    "hashes": "Both trials of a pair share their keys and a hash of how they started; nothing "
    "shows that later noise was the same.",
}


def sentences(result: AuditResult) -> tuple[str, ...]:
    """Return all that a result says, a sentence or two each: changes first, then the answers."""
    changes = [phrases.change(result, change) for change in result.changes if not result.invalid]
    above = {*_unchanged(result)}  # change by change
    return (*changes, *(s for s in sum(_answers(result).values(), list[str]()) if s not in above))


def answers(result: AuditResult) -> dict[str, str]:
    """Return `What follows`, `How sure` and `Left open`, each with a sentence or a few.

    With too few scenes nothing follows, and only the other two are there.
    """
    return {label: " ".join(sentences) for label, sentences in _answers(result).items()}


def _answers(result: AuditResult) -> dict[str, list[str]]:
    question, significant = result.question, any(effect.sign for effect in result.effects)
    least, unit = result.testing.scenes_needed, result.facts.unit
    if result.invalid:
        return {"Left open": [_WHY_NO_RESULT[result.invalid]]}
    sure = [*_reach(result), *_hardly_acted(result)]
    if result.few:
        few = (
            f"Too few {unit}s: {counted(result.scenes, unit)} compared, and no difference can be "
            f"significant with fewer than {least}. The numbers hold for them alone."
        )
        return {"Left open": [few], "How sure": sure}
    if result.earlier:
        sure.append(phrases.earlier_analyses(result))
    elif significant and not result.facts.judged and question.generalise == "scenes":
        # Of other tools' trials it is said with how they were paired.
        sure.append(
            "If both versions were equally good, at most 5 % of audits would report any difference."
        )
    follows = {"What follows": list(_follows(result)), "How sure": sure}
    left_open = {"Left open": list(_left_open(result))}
    # Where nothing is significant, what was not seen is the result.
    return {**follows, **left_open} if significant else {**left_open, **follows}


def _follows(result: AuditResult) -> Iterator[str]:
    tested = [effect for effect in result.effects if effect.acted]
    leading = [effect for effect in tested if effect.leads]
    disagree = {effect.sign for effect in leading} == {1, -1}
    if not leading:
        if uneven := [effect for effect in tested if effect.sign and effect.uneven]:
            failed = phrases.failed_more(result, uneven[0])
            yield f"No choice can rest on what is significant: {failed}."
        elif any(effect.sign for effect in tested):
            yield "What is significant lies at the floor or ceiling: no choice can rest on it."
        elif tested and all(result.is_small(effect) for effect in tested):
            yield f"Neither is to be preferred: each difference is below {margin(result)}."
        else:
            yield _unknown(result)
    reversals = reversed_at(result)
    if reversals:
        one, other = result.winner(reversals[0].sign), result.winner(-reversals[0].sign)
        yield (
            f"Ask which fault your system will meet: {places(reversals)}, {one} succeeds more "
            f"often; where the modules share it, {other} succeeds more often."
        )
        leading = [effect for effect in leading if effect.condition == CORRECT]
    for sign in (1, -1):
        if at := [effect for effect in leading if effect.sign == sign]:
            yield f"{capital(places(at))}, {result.winner(sign)} succeeds more often."
    alone = any(effect.condition not in (CORRECT, SHARED) for effect in leading)
    for effect in tested if alone else ():
        if effect.condition == SHARED and not (effect.sign or effect.extreme or effect.unsettled):
            less = f", and any is below {margin(result)}" if result.is_small(effect) else ""
            yield f"When the fault is shared, no difference is significant{less}."
    if modules := [change.isolated for change in result.changes if change.turn == "interaction"]:
        yield (
            f"A fault at the {' or the '.join(modules)} alone does not stand for the shared one: "
            "the difference between the two versions changes."
        )
    if disagree and not reversals:
        yield "Which is better depends on which fault occurs, and how often."
    for share in result.break_even if disagree else ():
        if share.condition == result.facts.primary and share.ahead:
            place, words = where(share.condition), phrases.ahead(result.question, share)
            yield f"Depending on how often the fault occurs, {place}: {words}."


def _unknown(result: AuditResult) -> str:
    """Say that no choice follows, and which differences the primary contrast leaves possible."""
    main = result.effect(result.facts.primary)
    text = "Not enough is known to prefer either"
    if main is None or not main.acted or main.low is None or main.high is None:
        return f"{text}."
    if main.unsettled:
        return f"{text}: {where(main.condition)} it depends on trials that failed."
    low, high = signed(main.low), signed(main.high)
    return f"{text}: {where(main.condition)}, any difference from {low} to {high} pp is possible."


def _reach(result: AuditResult) -> Iterator[str]:
    """Say how far the numbers reach, which seeds repeat, and how a sequential audit stopped."""
    question, facts = result.question, result.facts
    significant = any(effect.sign for effect in result.effects)
    holds = "What is significant holds" if significant else "The intervals hold"
    conditional = facts.trained and question.generalise == "scenes"
    anew = "; models trained anew may differ" if conditional else ""
    yield f"{holds} for {phrases.estimand(question, facts)}{anew}."
    if facts.pairing in _PAIRED:
        yield _PAIRED[facts.pairing]
        yield (
            "If both versions were equally good, at most 5 % of such comparisons would report any "
            f"difference, provided that the number of {facts.unit}s was fixed before anybody "
            "looked: other tools do not say whether it was."
        )
    run = len(facts.seeds)
    yield from phrases.for_trainings(result)
    if run > 1 and facts.unit == "scene" and result.effects and len(result.effects[0].won) == 1:
        yield f"All {run} seeds gave the same outcome in every trial: together they count as one."
    yield from _stopped(result)


def _hardly_acted(result: AuditResult) -> Iterator[str]:
    """Name the versions in which the fault changed nothing in most of the trials."""
    acted = {effect.condition for effect in result.effects if effect.acted}
    faulted = {
        condition.name: (condition.baseline_readers, condition.readers)
        for condition in result.conditions
    }
    for count in result.counts:
        readers = faulted[count.condition][count.variant == result.question.repair]
        if count.condition in acted and readers and 2 * count.altered_trials < count.trials:
            few = f"only {count.altered_trials}" if count.altered_trials else "none"
            yield (
                f"{capital(where(count.condition))}, the fault changed something in {few} of "
                f"{counted(count.trials, 'trial')} of {count.variant}."
            )


def _stopped(result: AuditResult) -> Iterator[str]:
    """Say when a sequential audit stopped, why, and what that means for its numbers."""
    stopped, question, facts = result.stopped, result.question, result.facts
    if stopped is None or facts.order is None:
        return
    whole = stopped.scenes == facts.n_scenes
    because = "but" if not stopped.reached else "and" if whole else "because"
    why = f"the primary contrast was {'' if stopped.reached else 'not '}significant"
    if question.stop_when == "all-decided":
        also = f" or smaller than {margin(result)}" if question.margin_pp else ""
        why = f"{'every' if stopped.reached else 'not every'} effect was significant{also}"
    elif result.facts.primary in stopped.small:
        why = f"the primary contrast was shown to be smaller than {margin(result)}"
    took = f"it {'stopped after' if stopped.reached else 'took'} {counted(stopped.scenes, 'scene')}"
    took += f" of at most {facts.n_scenes}"
    if whole:
        took = f"it took all that it was allowed, {counted(stopped.scenes, 'scene')}"
    trials = counted(stopped.scenes * facts.order.trials, "trial")
    yield f"This audit was sequential: {took} ({trials}), {because} {why}."
    yield (
        "Its scenes came in a random order fixed beforehand. Intervals and p-values hold wherever "
        "an audit stops, and are wider for that."
    )
    every = question.stop_when == "all-decided"
    if stopped.reached and any(
        effect.sign for effect in result.effects if every or effect.condition == facts.primary
    ):
        yield (
            "A significant difference with which an audit stops is on average further from 0 than "
            "the truth."
        )


def _left_open(result: AuditResult) -> Iterator[str]:
    if idle := [where(effect.condition) for effect in result.effects if not effect.acted]:
        yield f"The fault never acted {series(idle)}: nothing was tested there."
    yield from phrases.in_trials_that_ran(result)
    yield from _insignificant(result)
    yield from phrases.not_standing(result)
    yield from _unchanged(result)
    if result.facts.judged:
        yield f"Other {result.facts.unit}s and other conditions are not among the results."
    else:
        yield (
            "Another size or sign of the fault, another library and another wiring were not tried."
        )


def _unchanged(result: AuditResult) -> Iterator[str]:
    if same := [e.isolated for e in result.changes if e.turn == "none" and not e.unsettled]:
        at = " or the ".join(same)
        yield f"No change from the fault at the {at} alone to the shared fault is significant."


def _insignificant(result: AuditResult) -> Iterator[str]:
    """Say where no difference is significant, and how large a one 8 of 10 audits would find."""
    sizes: dict[str, str] = {}
    extreme: dict[str, list[str]] = {}
    for effect in result.effects:
        if not effect.acted or effect.sign or effect.unsettled or result.is_small(effect):
            continue
        if effect.extreme:
            extreme.setdefault(effect.extreme, []).append(where(effect.condition))
        else:
            sizes[where(effect.condition)] = detectable(effect)
    for end, at in extreme.items():
        both = "fail" if end == "floor" else "succeed"
        yield f"No difference is significant {series(at)}, where both nearly always {both}."
    if not sizes:
        return
    text = f"No difference is significant {series(list(sizes))}"
    if MISSING not in sizes.values():
        least, most = (end(map(int, sizes.values())) for end in (min, max))
        size = f"{least} pp" if least == most else f"{least} to {most} pp, by condition,"
        text += f": only those of about {size} or more would have been found in 8 of 10 audits"
    yield f"{text}."


def would_change(result: AuditResult) -> Iterator[str]:
    """Say what would change the result."""
    if result.invalid:
        yield "Trials that repeat and are pairs: see the remarks on what differed."
        return
    stopped, tested = result.stopped, [effect for effect in result.effects if effect.acted]
    judged, unit = result.facts.judged, result.facts.unit
    if stopped and not stopped.reached:
        yield (
            "More scenes: a larger --scenes goes on with those of the same order, and what is said "
            "then holds as well."
        )
    elif result.question.stop_when == "decided" and not all(e.sign for e in result.effects):
        yield (
            "More scenes: --stop-when all-decided goes on until every effect is significant or "
            "shown to be small."
        )
    if result.few:
        least = result.testing.scenes_needed
        yield f"More {unit}s: {least} at least, and more for all but a clear winner."
    if len(tested) < len(result.effects):
        yield "A fault that acts: an onset before the trial ends, a size that changes what is read."
    if any(effect.extreme == "floor" for effect in tested):
        yield "Easier scenes or a smaller fault: where both fail, a difference can hardly show."
    if any(effect.extreme == "ceiling" for effect in tested):
        yield "Harder scenes or a larger fault: where both succeed, a difference can hardly show."
    if not result.few and any(e.least_pp and not e.sign for e in tested):
        instead = "" if judged else ", or --stop-when, which allows for several analyses"
        yield (
            f"Fresh {unit}s, which no audit has used, and more of them{instead}: they find smaller "
            f"differences. Adding {unit}s to this audit would raise its error rate above 5 %."
        )
    if judged:
        yield f"Other {unit}s, other conditions: none of these is among the results."
    else:
        yield "Another size or sign of the fault, another library or wiring: none of these was run."
