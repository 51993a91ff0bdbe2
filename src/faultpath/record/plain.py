"""What a record says in three plain sentences: what follows, how sure it is, what stays open.

They are made from decisions, as all other words of a record, and are what a reader sees who opens
nothing else. So whatever qualifies a decision is said here too.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import takewhile

from faultpath.record.family import CORRECT, SHARED
from faultpath.record.headline import places, reversed_at
from faultpath.record.looks import look_words
from faultpath.record.model import DecisionRecord, Effect
from faultpath.record.words import (
    About,
    adjusted,
    barely_acted,
    capital,
    margin,
    only_alone,
    series,
    where,
)


def about(record: DecisionRecord) -> About:
    """Return what sentences need to know of a finished record."""
    small = frozenset(record.stopped.small if record.stopped else ())
    return About(record.question, record.scenes, record.scenes_needed, small)


def plain_words(record: DecisionRecord) -> dict[str, str]:
    """Return `What follows`, `How sure` and `Not decided`, each with a sentence or a few.

    With too few scenes nothing follows, and only the other two are there.
    """
    known = about(record)
    if known.few:
        scenes = f"{known.scenes} scene{'' if known.scenes == 1 else 's'}"
        few = (
            f"Too few scenes to decide: {scenes} compared, and this question needs at least "
            f"{known.needed}. The numbers tell of {'it' if known.scenes == 1 else 'them'} alone."
        )
        return {"Not decided": few, "How sure": " ".join(_qualified(record))}
    return {
        "What follows": " ".join([*_follows(known, record), *_changed(record)]),
        "How sure": " ".join(_sure(record)),
        "Not decided": " ".join(_left_open(known, record)),
    }


def decided_words(known: About, effect: Effect | None) -> str:
    """Say in a few words what is decided of one path."""
    if effect is None:
        return "no pair of trials to compare"
    if not effect.acted:
        return "the fault never acted: not tested"
    if effect.detected:
        at = f", but at the {effect.extreme}" if effect.extreme else ""
        at = at or (", but trials failed unevenly" if effect.uneven else "")
        return f"{known.winner(effect.sign)} succeeds more often{at}"
    if effect.unsettled:
        return "open: trials that failed could decide it"
    if known.few:
        return "too few scenes to decide"
    p = f" ({adjusted(known.question, effect)})" if only_alone(effect) else ""
    if effect.path in known.small and known.question.stop:
        return f"differ by less than {margin(known.question.stop)}{p}"
    return f"no difference detected{p}"


def not_standing(record: DecisionRecord) -> Iterator[str]:
    """Say of each interval that leaves out 0 where nothing is detected why it does not count."""
    for effect in record.effects:
        if only_alone(effect):
            yield (
                f"{capital(where(effect.path))} the interval by itself leaves out 0, but "
                f"{adjusted(record.question, effect)} ({record.hypotheses} contrasts): no "
                "difference is detected."
            )


def _follows(known: About, record: DecisionRecord) -> Iterator[str]:
    """Say what the decisions add up to: of the fault, and of correct inputs beside it."""
    tested = [effect for effect in record.effects if effect.acted]
    leading = [effect for effect in tested if effect.leads]
    if not leading:
        if any(effect.detected and effect.uneven for effect in tested):
            yield "No choice can rest on what is decided: one arm's trials failed more often."
        elif any(effect.detected for effect in tested):
            yield "What is decided lies at the floor or ceiling, where no choice can rest on it."
        else:
            yield "Nothing that was tested gives a reason to prefer either."
        return
    turned = reversed_at(tested, record.changes)
    if turned:
        sign = turned[0].sign
        yield (
            f"Ask which fault your system will meet: {places(turned)}, "
            f"{known.winner(sign)} succeeds more often; where the modules share it, "
            f"{known.winner(-sign)} succeeds more often."
        )
    else:
        yield from _faulty(known, tested)
    correct = next((effect for effect in leading if effect.path == CORRECT), None)
    if correct and sum(effect.detected for effect in tested) == 1 < len(tested):
        winner = known.winner(correct.sign)
        yield f"Only under correct inputs is a difference detected: {winner} succeeds more often."
    elif correct:
        yield f"Under correct inputs, {known.winner(correct.sign)} succeeds more often."
    if len({effect.sign for effect in leading}) == 2:
        yield from _depends(record, reversal=bool(turned))


def _faulty(known: About, tested: Sequence[Effect]) -> Iterator[str]:
    """Say what is decided with the fault, where sharing it reverses nothing.

    That one fault shows a difference and the other does not is no difference between the two.
    """
    alone = [effect for effect in tested if effect.path not in (CORRECT, SHARED)]
    isolated, shared = ([e for e in some if e.leads] for some in (alone, _shared(tested)))
    decided = [*isolated, *shared]
    signs = sorted({effect.sign for effect in decided}, reverse=True)
    seen, missed = ("in isolation", "when the fault is shared")
    if shared:
        seen, missed = missed, seen
    unseen = alone if shared else _shared(tested)
    open_ = bool(decided and unseen) and not any(
        e.detected or e.extreme or e.unsettled for e in unseen
    )
    if open_ and len(signs) == 1:
        yield f"The {'gain' if signs == [1] else 'loss'} seen {seen} is not seen {missed}."
    else:
        for sign in signs:
            at = [effect for effect in decided if effect.sign == sign]
            yield f"{capital(places(at))}, {known.winner(sign)} succeeds more often."
        if open_:
            yield f"{capital(missed)}, no difference is seen."
    small = [effect for effect in unseen if effect.path in known.small]
    if open_ and small and known.question.stop:
        less = margin(known.question.stop)
        yield f"{capital(places(small))}, the difference is smaller than {less}."


def _shared(tested: Sequence[Effect]) -> list[Effect]:
    return [effect for effect in tested if effect.path == SHARED]


def _changed(record: DecisionRecord) -> Iterator[str]:
    """Say where a test at one module is decided not to stand for the shared fault."""
    modules = " or the ".join(c.isolated for c in record.changes if c.turn == "interaction")
    if modules:
        yield (
            f"A fault at the {modules} alone does not stand for the shared one: the difference "
            "between the two arms changes."
        )


def _depends(record: DecisionRecord, reversal: bool) -> Iterator[str]:
    """Say that the paths disagree, and what is decided of the primary fault's frequency."""
    if not reversal:
        yield "Which is better depends on which fault occurs, and how often: the paths disagree."
    told = [each for each in record.break_even if each.path == record.question.primary]
    if told and told[0].words:
        yield f"By the share of trials with the fault, {where(told[0].path)}: {told[0].words}."


def _qualified(record: DecisionRecord) -> Iterator[str]:
    """Return what the record says before its numbers (their reach, seeds that repeat, how it
    stopped), and where the fault hardly acted."""
    effects = {effect.words for effect in record.effects}
    yield from takewhile(lambda sentence: sentence not in effects, record.verdict.sentences)
    yield from barely_acted(record.question, record.paths, record.cells)


def _sure(record: DecisionRecord) -> Iterator[str]:
    yield from _qualified(record)
    if record.earlier:
        yield look_words(record.earlier)
    elif record.question.generalise == "scenes" and any(each.detected for each in record.effects):
        yield "Of audits of two equal systems, at most 5 % would decide anything."


def _left_open(known: About, record: DecisionRecord) -> Iterator[str]:
    idle = [where(effect.path) for effect in record.effects if not effect.acted]
    if idle:
        yield f"The fault never acted {series(idle)}: nothing was tested there."
    undecided = [
        effect
        for effect in record.effects
        if effect.acted
        and not (effect.detected or effect.unsettled)
        and effect.path not in known.small
    ]
    if unsettled := [where(effect.path) for effect in record.effects if effect.unsettled]:
        yield f"Who is ahead {series(unsettled)} hangs on trials that failed."
    if undecided:
        yield f"No difference is detected {series(_missed(undecided))}."
    yield from not_standing(record)
    same = [each.isolated for each in record.changes if each.turn == "none" and not each.unsettled]
    if same:
        places = " or the ".join(same)
        yield f"No change is detected from the fault at the {places} alone to the shared fault."
    yield "Another size or sign of the fault, another library and another wiring were not tried."


def _missed(effects: Sequence[Effect]) -> list[str]:
    said: list[str] = []
    for effect in effects:
        least = effect.findable_pp
        if effect.extreme:
            ends = "fail" if effect.extreme == "floor" else "succeed"
            aside = f" (both nearly always {ends})"
        else:
            found = f"a true one of {math.ceil(least or 0)} pp would be found in 8 of 10 audits"
            aside = "" if least is None else f" ({found})"
        said.append(where(effect.path) + aside)
    return said
