"""The headline: at most twenty words that rest on decided things, led by the primary contrast.

What qualifies it stands in the sentences below: numbers, trained models, a change that is detected.
"""

from collections.abc import Iterator, Sequence

from faultpath.record.family import CORRECT, SHARED
from faultpath.record.model import Change, Effect
from faultpath.record.void_words import no_pair
from faultpath.record.words import About, capital, margin, series, where

MOST_WORDS = 20
"""Of a headline, with the names of modules and variants as one word each."""

_UNSEEN = "; under the shared fault, no difference is detected"


def headline(about: About, effects: Sequence[Effect], changes: Sequence[Change]) -> str:
    """Return the headline of an audit."""
    asked = about.question
    main = next((effect for effect in effects if effect.path == asked.primary), None)
    if main is None:
        return f"{capital(no_pair(asked.primary))}."
    if about.few:
        return (
            f"Too few scenes to decide: {about.scenes} compared, and this question needs at least "
            f"{about.needed}."
        )
    if not main.acted:
        return _never_acted(main, effects)
    tested = [effect for effect in effects if effect.acted]
    if said := _saturated(tested):
        return said
    if turned := reversed_at(tested, changes):
        return _fitting(_reversal(about, main, tested, turned))
    return _fitting((_ahead if main.leads else _undecided)(about, main, effects))


def _fitting(candidates: Iterator[str]) -> str:
    said = ""
    for said in candidates:
        if len(said.split()) <= MOST_WORDS:
            break
    return said


def _never_acted(main: Effect, effects: Sequence[Effect]) -> str:
    if any(effect.acted for effect in effects if effect.path != CORRECT):
        return f"{capital(where(main.path))}, the fault never acted: nothing was tested there."
    return "The fault never acted: nothing was tested."


def _saturated(tested: Sequence[Effect]) -> str:
    rates = [(effect.baseline_percent, effect.repair_percent) for effect in tested]
    if any(base != fix or base not in (0.0, 100.0) for base, fix in rates):
        return ""
    ends = {base for base, _ in rates}
    every = {0.0: "fail", 100.0: "succeed"}
    what = " or ".join(f"{every[end]} in every scene" for end in sorted(ends, reverse=True))
    return f"No difference could show: on every path both arms {what}."


def reversed_at(tested: Sequence[Effect], changes: Sequence[Change]) -> list[Effect]:
    """Return the isolated effects that sharing reverses, where advice may rest on both."""
    of = {effect.path: effect for effect in tested}
    return [
        of[change.isolated]
        for change in changes
        if change.turn == "reversal" and of[change.isolated].leads and of[change.shared].leads
    ]


def _reversal(
    about: About, main: Effect, tested: Sequence[Effect], turned: Sequence[Effect]
) -> Iterator[str]:
    advice, sign = "Do not choose by the isolated fault", turned[0].sign
    if main.path != SHARED and main not in turned:
        decided = f"{about.winner(main.sign)} is ahead {where(main.path)}"
        lead = decided if main.leads else f"{capital(where(main.path))}, {_briefly(about, main)}"
        yield f"{lead}. {advice}: sharing reverses the ranking."
        yield f"{advice}: sharing reverses the ranking."
        return
    isolated = [effect for effect in tested if effect.path not in (CORRECT, SHARED)]
    some = f"at {len(turned)} of {len(isolated)} modules"
    every = "with only one module struck"
    for at in (places(turned), every if len(turned) == len(isolated) else some):
        yield (
            f"{advice}: {about.winner(sign)} is ahead {at}, {about.winner(-sign)} with the "
            "fault shared."
        )


def _ahead(about: About, main: Effect, effects: Sequence[Effect]) -> Iterator[str]:
    winner, loser = about.winner(main.sign), about.winner(-main.sign)
    others = [effect for effect in effects if effect.leads and effect is not main]
    same = [effect for effect in others if effect.sign == main.sign]
    against = [effect for effect in others if effect.sign != main.sign]
    if same and len(same) == len(effects) - 1:
        yield f"{winner} is ahead of {loser} on every path."
    ahead, at = places([main, *same]), places(against)
    more = f" and on {_paths(same, ' other')}" if same else ""
    # A gain in isolation reads as advice unless what came of it when shared stands beside it.
    for open_ in (_UNSEEN, "")[not _open(effects) :]:
        yield f"{winner} is ahead of {loser} {ahead}{f'; {loser} is ahead {at}' * bool(at)}{open_}."
        yield f"{winner} is ahead {ahead}{f'; {loser} is ahead {at}' * bool(at)}{open_}."
        yield f"{winner} is ahead {ahead}{f'; {loser} {at}' * bool(at)}{open_}."
        if open_ and not against:
            yield f"{winner} is ahead {where(main.path)}{open_}."
    yield (
        f"{winner} is ahead {where(main.path)}{more}{f'; {loser} on {_paths(against)}' * bool(at)}."
    )


def _open(effects: Sequence[Effect]) -> bool:
    shared = (effect for effect in effects if effect.path == SHARED and effect.acted)
    return any(not (each.sign or each.extreme or each.unsettled) for each in shared)


def _undecided(about: About, main: Effect, effects: Sequence[Effect]) -> Iterator[str]:
    place, briefly = capital(where(main.path)), _briefly(about, main)
    others = [effect for effect in effects if effect.leads]
    sides = {
        about.winner(sign): [effect for effect in others if effect.sign == sign]
        for sign in (1, -1)
        if any(effect.sign == sign for effect in others)
    }
    said = f"no difference between {about.both} is detected"
    if main.extreme or _marred(main):
        said = f"{about.both} {briefly}" if main.extreme else briefly
    elif main.path in about.small:
        said = briefly
    if not others:
        if main.extreme:
            said += ": no choice can rest on it"
        elif len(effects) > 1 and main.path not in about.small and not any(map(_marred, effects)):
            extreme = any(effect.extreme for effect in effects if effect.acted)
            place = "away from the floor and the ceiling" if extreme else "on any path"
            tested = "" if all(effect.acted for effect in effects) else " that was tested"
            yield f"{capital(said)} {place}{tested}."
        yield f"{place}, {said}."
        return
    ahead = "; ".join(f"{who} is ahead {places(at)}" for who, at in sides.items())
    (first, at), *rest = sides.items()
    more = (f"{who} on {len(at)}" for who, at in rest)
    counted = ", ".join([f"{first} is ahead on {_paths(at)}", *more])
    if main.path != SHARED and _open(effects):
        if main.extreme or main.path in about.small or _marred(main):
            yield f"{place}, {briefly}{_UNSEEN}."
            return
        place = capital(places([main, *(e for e in effects if e.path == SHARED)]))
    else:
        yield f"{place}, {said}; {ahead}."
    yield f"{place}, {briefly}; {ahead}."
    yield f"{place}, {briefly}; {counted}."
    yield f"{place}, {briefly}."


def _briefly(about: About, main: Effect) -> str:
    """Say in at most six words that the primary contrast is open."""
    if main.extreme:
        return f"both nearly always {'fail' if main.extreme == 'floor' else 'succeed'}"
    if _marred(main):
        return "trials that failed leave it open"
    if main.path in about.small and about.question.stop:
        return f"the difference is below {margin(about.question.stop)}"
    return "no difference is detected"


def _marred(effect: Effect) -> bool:
    return effect.uneven or effect.unsettled


def _paths(effects: Sequence[Effect], other: str = "") -> str:
    return f"{len(effects)}{other} path{'' if len(effects) == 1 else 's'}"


def places(effects: Sequence[Effect]) -> str:
    """Return where effects are, the first one's kind first, modules struck alone together."""
    alone = [effect.path for effect in effects if effect.path not in (CORRECT, SHARED)]
    joined = where(" or the ".join(alone))
    places = (joined if effect.path in alone else where(effect.path) for effect in effects)
    return series(list(dict.fromkeys(places))) if effects else ""
