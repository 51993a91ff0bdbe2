"""The headline, and three plain answers: what follows, how sure it is, what stays open.

Whoever reads nothing else reads these, so what qualifies a decision is said here too.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from faultpath.decisions import phrases, wording
from faultpath.decisions.model import CORRECT, SHARED, DecisionRecord, Effect
from faultpath.decisions.phrases import adjusted, margin, only_alone
from faultpath.decisions.tables import MISSING
from faultpath.decisions.wording import capital, counted, series, where

MOST_WORDS = 20
"""Most words of a headline; names of modules and variants are one word each."""
_OPEN = "no difference is detected"


def headline(record: DecisionRecord) -> str:
    """Return at most twenty words that rest on decided things, led by the primary contrast."""
    main = next(
        (effect for effect in record.effects if effect.path == record.question.primary), None
    )
    if main is None:
        return f"{phrases.no_pair(record.question.primary)}."
    if record.few:
        return (
            f"Too few scenes to decide: {record.scenes} compared, and this question needs at least "
            f"{record.scenes_needed}."
        )
    tested = [effect for effect in record.effects if effect.acted]
    if not main.acted:
        if all(effect.path == CORRECT for effect in tested):
            return "The fault never acted: nothing was tested."
        return f"{capital(where(main.path))}, the fault never acted: nothing was tested there."
    ends = {rate for effect in tested for rate in (effect.baseline_percent, effect.repair_percent)}
    if ends <= {0.0, 100.0} and not any(any((*e.wins, *e.losses)) for e in tested):
        every = [word for end, word in ((100.0, "succeed"), (0.0, "fail")) if end in ends]
        return f"No difference could show: in every scene both arms {' or '.join(every)}."
    turned = reversed_at(record)
    text = ""
    for text in _turned(record, main, turned) if turned else _compared(record, main, tested):
        if len(text.split()) <= MOST_WORDS:
            break
    return text


def reversed_at(record: DecisionRecord) -> list[Effect]:
    """Return the isolated effects that sharing reverses, where advice may rest on both."""
    of = {effect.path: effect for effect in record.effects if effect.leads}
    return [
        of[change.isolated]
        for change in record.changes
        if change.turn == "reversal" and change.isolated in of and change.shared in of
    ]


def _turned(record: DecisionRecord, main: Effect, turned: Sequence[Effect]) -> Iterator[str]:
    modules = " or ".join(effect.path for effect in turned)
    one, other = record.winner(turned[0].sign), record.winner(-turned[0].sign)
    leads = main.path == SHARED or main in turned
    correct = [e.sign for e in record.effects if e.path == CORRECT and e.leads]
    if turned[0].sign in correct:  # a test there shows no more than one without the fault
        if leads:
            yield (
                f"{one} is ahead without the fault and with it at the {modules} alone, {other} "
                "with it shared."
            )
        yield f"{one} is ahead without the fault, {other} with it shared."
        return
    advice = f"Do not choose by the fault at the {modules} alone"
    if leads:
        yield f"{advice}: {one} is ahead there, {other} with it shared."
    else:
        yield f"{_sentence(record, [[main]])} {advice}: sharing reverses the ranking."
    yield f"{advice}: sharing reverses the ranking."


def _compared(record: DecisionRecord, main: Effect, tested: Sequence[Effect]) -> Iterator[str]:
    """Yield the primary contrast with what is like it; then the shared one, so that no gain in
    isolation stands without what came of it; then whatever else is decided."""
    groups: dict[str, list[Effect]] = {}
    ordered = sorted(tested, key=lambda effect: (effect is not main, effect.path != SHARED))
    for effect in ordered:
        state = _state(record, effect)
        if effect.leads or effect.path == SHARED or state == _state(record, main):
            groups.setdefault(state, []).append(effect)
    grouped, shared = list(groups.values()), [[e] for e in ordered[1:] if e.path == SHARED]
    if len(grouped) == 1 and len(grouped[0]) == len(record.effects) > 1:
        yield _sentence(record, grouped, both=True, everywhere=True)
    ahead = [[e for e in group if e.path != SHARED] for group in grouped[1:] if group[0].leads]
    for clauses in (grouped, [[main], *shared, *filter(None, ahead)]):
        yield _sentence(record, clauses, both=True)
        yield _sentence(record, clauses)
    yield _sentence(record, [[main], *shared])
    yield _sentence(record, [[main]])


def _sentence(
    record: DecisionRecord,
    groups: Sequence[Sequence[Effect]],
    both: bool = False,
    everywhere: bool = False,
) -> str:
    """Return a sentence with a clause for each group of like effects; `both` names both arms."""
    question, clauses = record.question, list[str]()
    for group in groups:
        clause, place = _state(record, group[0]), places(group)
        if everywhere:
            place = "on every path" if group[0].leads else "on any path"
        if both and not clauses and group[0].leads:
            clause += f" of {record.winner(-group[0].sign)}"
        elif both and not clauses and clause == _OPEN:
            clause = f"no difference between {question.baseline} and {question.repair} is detected"
        clauses.append(f"{clause} {place}")
    sentence = f"{'; '.join(clauses)}."
    return sentence if groups[0][0].leads else capital(sentence)


def _state(record: DecisionRecord, effect: Effect) -> str:
    """Return what is decided of a path, as a clause without its place."""
    if effect.leads:
        return f"{record.winner(effect.sign)} is ahead"
    if effect.extreme:
        return f"both nearly always {'fail' if effect.extreme == 'floor' else 'succeed'}"
    if effect.uneven or effect.unsettled:
        return "trials that failed leave it open"
    if record.is_small(effect):
        return f"the difference is below {margin(record)}"
    return _OPEN


def places(effects: Sequence[Effect]) -> str:
    """Return where effects are, the first one's kind first, modules faulted alone together."""
    alone = [effect.path for effect in effects if effect.path not in (CORRECT, SHARED)]
    joined = where(" or the ".join(alone))
    named = (joined if effect.path in alone else where(effect.path) for effect in effects)
    return series(list(dict.fromkeys(named)))


def in_short(record: DecisionRecord, effect: Effect | None) -> str:
    """Say in a few words what is decided of one path."""
    if effect is None:
        return "no pair of trials to compare"
    if not effect.acted:
        return "the fault never acted: not tested"
    if effect.sign:
        at = f", but at the {effect.extreme}" if effect.extreme else ""
        at = at or (", but trials failed unevenly" if effect.uneven else "")
        return f"{record.winner(effect.sign)} succeeds more often{at}"
    if effect.unsettled:
        return "open: trials that failed could decide it"
    if record.few:
        return "too few scenes to decide"
    p = f" ({adjusted(record, effect)})" if only_alone(effect) else ""
    if record.is_small(effect):
        return f"differ by less than {margin(record)}{p}"
    return f"no difference detected{p}"


def not_standing(record: DecisionRecord) -> Iterator[str]:
    """Say of each interval that leaves out 0 where nothing is detected why it does not count."""
    for effect in filter(only_alone, record.effects):
        yield (
            f"{capital(where(effect.path))}, the interval by itself leaves out 0, but "
            f"{adjusted(record, effect)} ({record.hypotheses} contrasts): no difference is "
            "detected."
        )


def in_words(record: DecisionRecord) -> dict[str, Any]:
    """Return the fields in which a record says what it decides."""
    changes = (phrases.change(record, change) for change in record.changes)
    sentences = [*changes, *(one for several in _answers(record).values() for one in several)]
    return {
        "headline": headline(record),
        "sentences": tuple(sentences),
        "would_change": tuple(phrases.would_change(record)),
    }


def answers(record: DecisionRecord) -> dict[str, str]:
    """Return `What follows`, `How sure` and `Left open`, each with a sentence or a few.

    With too few scenes nothing follows, and only the other two are there.
    """
    return {label: " ".join(sentences) for label, sentences in _answers(record).items()}


def _answers(record: DecisionRecord) -> dict[str, list[str]]:
    sure = [*phrases.reach(record), *phrases.hardly_acted(record)]
    if record.few:
        few = (
            f"Too few scenes to decide: {counted(record.scenes, 'scene')} compared, and this "
            f"question needs at least {record.scenes_needed}. The numbers are theirs alone."
        )
        return {"Left open": [few], "How sure": sure}
    if record.earlier:
        sure.append(phrases.looks(record))
    elif record.question.judged:
        pass  # it is said of how trials were paired
    elif record.question.generalise == "scenes" and any(effect.sign for effect in record.effects):
        sure.append("Of audits of two equal systems, at most 5 % would find any difference.")
    sentences = {"What follows": list(_follows(record)), "How sure": sure}
    left_open = {"Left open": list(_left_open(record))}
    # Where nothing is significant, what was not seen is the result.
    significant = any(effect.sign for effect in record.effects)
    return {**sentences, **left_open} if significant else {**left_open, **sentences}


def _follows(record: DecisionRecord) -> Iterator[str]:
    tested = [effect for effect in record.effects if effect.acted]
    leading = [effect for effect in tested if effect.leads]
    if not leading:
        if any(effect.sign and effect.uneven for effect in tested):
            yield "No choice can rest on what is significant: one arm's trials failed more often."
        elif any(effect.sign for effect in tested):
            yield "What is significant lies at the floor or ceiling: no choice can rest on it."
        else:
            yield "Nothing that was tested gives a reason to prefer either."
    turned = reversed_at(record)
    if turned:
        one, other = record.winner(turned[0].sign), record.winner(-turned[0].sign)
        yield (
            f"Ask which fault your system will meet: {places(turned)}, {one} succeeds more often; "
            f"where the modules share it, {other} succeeds more often."
        )
        leading = [effect for effect in leading if effect.path == CORRECT]
    for sign in (1, -1):
        if at := [effect for effect in leading if effect.sign == sign]:
            yield f"{capital(places(at))}, {record.winner(sign)} succeeds more often."
    alone = any(effect.path not in (CORRECT, SHARED) for effect in leading)
    shared = [effect for effect in tested if effect.path == SHARED]
    unseen = [e for e in shared if not (e.sign or e.extreme or e.unsettled)]
    if unseen and alone:
        less = f", and it is smaller than {margin(record)}" if record.is_small(unseen[0]) else ""
        yield f"When the fault is shared, no difference is seen{less}."
    if modules := [change.isolated for change in record.changes if change.turn == "interaction"]:
        yield (
            f"A fault at the {' or the '.join(modules)} alone does not stand for the shared one: "
            "the difference between the two arms changes."
        )
    if {effect.sign for effect in tested if effect.leads} == {1, -1}:
        if not turned:
            yield "Which is better depends on which fault occurs, and how often."
        for result in record.break_even:
            if result.path == record.question.primary and result.words:
                place = where(result.path)
                yield f"By the share of trials with the fault, {place}: {result.words}."


def _undetected(record: DecisionRecord) -> Iterator[str]:
    """Say where no difference is detected, and how large one would have been found."""
    sizes: dict[str, str] = {}
    extreme: dict[str, list[str]] = {}
    for effect in record.effects:
        if not effect.acted or effect.sign or effect.unsettled or record.is_small(effect):
            continue
        if effect.extreme:
            extreme.setdefault(effect.extreme, []).append(where(effect.path))
        else:
            sizes[where(effect.path)] = wording.detectable(effect)
    for end, at in extreme.items():
        both = "fail" if end == "floor" else "succeed"
        yield f"No difference is detected {series(at)}, where both nearly always {both}."
    if sizes:
        yield f"No difference is detected {series(list(sizes))}{_would_be_found(sizes)}."


def _would_be_found(sizes: Mapping[str, str]) -> str:
    """Return how large a true difference 8 of 10 audits find, in order of the places."""
    if MISSING in sizes.values():
        return ""
    if len(set(sizes.values())) == 1:
        true = f"a true one of {next(iter(sizes.values()))} pp"
    else:
        true = f"true ones of {series(list(sizes.values()))} pp, in this order,"
    return f"; {true} would be found in 8 of 10 audits"


def _left_open(record: DecisionRecord) -> Iterator[str]:
    if idle := [where(effect.path) for effect in record.effects if not effect.acted]:
        yield f"The fault never acted {series(idle)}: nothing was tested there."
    if unsettled := [where(effect.path) for effect in record.effects if effect.unsettled]:
        yield f"Who is ahead {series(unsettled)} depends on trials that failed."
    yield from _undetected(record)
    yield from not_standing(record)
    if same := [e.isolated for e in record.changes if e.turn == "none" and not e.unsettled]:
        at = " or the ".join(same)
        yield f"No change is detected from the fault at the {at} alone to the shared fault."
    if record.question.judged:
        yield "Other scenes and other conditions are not among the results."
        return
    yield "Another size or sign of the fault, another library and another wiring were not tried."
