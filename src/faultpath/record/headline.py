"""The headline: one sentence that rests on decided things, led by the primary contrast."""

from collections.abc import Sequence

from faultpath.record.model import Change, Effect
from faultpath.record.words import About, capital, margin, no_pair, series, where


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
    return (
        _saturated(tested)
        or _reversal(about, tested, changes)
        or _led(about, main, effects) + _interaction(main, changes) + "."
    )


def _never_acted(main: Effect, effects: Sequence[Effect]) -> str:
    if any(effect.acted for effect in effects if effect.path != "correct"):
        return f"{capital(where(main.path))}, the fault never acted: nothing was tested there."
    return "The fault never acted: nothing was tested."


def _saturated(tested: Sequence[Effect]) -> str:
    """Return the headline where no arm can be told from another: all at 0 %, or all at 100 %."""
    rates = [(effect.baseline_percent, effect.repair_percent) for effect in tested]
    if any(base != fix or base not in (0.0, 100.0) for base, fix in rates):
        return ""
    ends = {base for base, _ in rates}
    every = {0.0: "fail", 100.0: "succeed"}
    what = " or ".join(f"{every[end]} in every scene" for end in sorted(ends, reverse=True))
    return f"No difference could show: on every path both arms {what}."


def _reversal(about: About, tested: Sequence[Effect], changes: Sequence[Change]) -> str:
    turned = reversed_at(tested, changes)
    if not turned:
        return ""
    of = {effect.path: effect for effect in tested}
    shared = of[changes[0].shared]
    primary = about.question.primary
    lead = ""
    if primary not in (shared.path, *(effect.path for effect in turned)):
        main = of[primary]
        lead = f"{_led(about, main, ())}. "
    places = " or the ".join(effect.path for effect in turned)
    return (
        f"{lead}Do not choose by the isolated fault: with only the {places} struck, "
        f"{about.winner(turned[0].sign)} is ahead; with the fault shared, "
        f"{about.winner(shared.sign)} is{_models(about)}."
    )


def reversed_at(tested: Sequence[Effect], changes: Sequence[Change]) -> list[Effect]:
    """Return the isolated effects that sharing reverses, where advice may rest on both."""
    of = {effect.path: effect for effect in tested}
    return [
        of[change.isolated]
        for change in changes
        if change.turn == "reversal" and of[change.isolated].leads and of[change.shared].leads
    ]


def _led(about: About, main: Effect, effects: Sequence[Effect]) -> str:
    """Return what is decided of `effects`, the primary contrast first."""
    others = [effect for effect in effects if effect.leads and effect is not main]
    sides = {sign: [effect for effect in others if effect.sign == sign] for sign in (1, -1)}
    if main.leads:
        ahead = f"{about.winner(main.sign)} is ahead of {about.winner(-main.sign)}"
        if len(effects) > 1 and len(sides[main.sign]) == len(effects) - 1:
            return f"{ahead} on every path{_models(about)}"
        text = f"{ahead} {_places([main, *sides[main.sign]])}"
        if sides[-main.sign]:
            text += f"; {about.winner(-main.sign)} is ahead {_places(sides[-main.sign])}"
        return text + _models(about)
    if not others and not main.extreme and len(effects) > 1 and main.path not in about.small:
        extreme = any(effect.extreme for effect in effects if effect.acted)
        place = "away from the floor and the ceiling" if extreme else "on any path"
        tested = "" if all(effect.acted for effect in effects) else " that was tested"
        return f"No difference between {about.both} is detected {place}{tested}"
    text = f"{capital(where(main.path))}, {_undecided(about, main)}"
    for sign, ahead in sides.items():
        if ahead:
            text += f"; {about.winner(sign)} is ahead {_places(ahead)}"
    return text + (_models(about) if others else "")


def _undecided(about: About, main: Effect) -> str:
    if main.extreme:
        ends = "fail" if main.extreme == "floor" else "succeed"
        return f"{about.both} both nearly always {ends}: no choice can rest on it"
    if main.path in about.small and about.question.stop:
        return f"{about.both} differ by less than {margin(about.question.stop)}"
    return f"no difference between {about.both} is detected"


def _interaction(main: Effect, changes: Sequence[Change]) -> str:
    """Return that the primary contrast is part of a change which is detected."""
    found = [
        change
        for change in changes
        if change.turn == "interaction" and main.path in (change.isolated, change.shared)
    ]
    if not found or main.extreme:
        return ""
    places = " or the ".join(change.isolated for change in found)
    return (
        f"; the difference is not the same with only the {places} struck as under the shared "
        "fault (interaction detected)"
    )


def _models(about: About) -> str:
    asked = about.question
    here = asked.trained and asked.generalise == "scenes"
    return " (for these trained models)" if here else ""


def _places(effects: Sequence[Effect]) -> str:
    return series([where(effect.path) for effect in effects])
