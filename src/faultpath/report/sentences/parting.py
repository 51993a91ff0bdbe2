"""Where two trials of a scene part, in words."""

from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import where
from faultpath.analyses.parting import Difference, Ended, Kind, Parting
from faultpath.core.text import capital, counted, one_line, series
from faultpath.report.sentences.wording import MINUS, ended, in_words, unit
from faultpath.system.outcome import control_steps

DIFFERS: dict[Kind, str] = {
    "reading": "readings differ",
    "command": "commands differ",
    "state": "state differs",
}
"""Differences by their kind, in two words."""
_LEAST, _MOST = 3, 17
"""Digits of the two values: so few that they still look different."""


def compared(parting: Parting) -> str:
    """Name what a parting is of: scene, seed, and what the two trials have in common."""
    one, other = parting.trials
    both = f"{one.condition}, {one.variant} and {other.variant}"
    if one.variant == other.variant:
        both = f"{one.variant}, {one.condition} and {other.condition}"
    return f"{parting.scene}, seed {parting.seed}, {both}"


def parted(facts: ComparisonFacts, parting: Parting) -> str:
    """Say what differs first between two trials and when, what follows, and how each ended."""
    if missing := [_missing(end) for end in parting.trials if end.missing]:
        return f"Nothing to compare: {series(missing)}."
    one, other = parting.trials
    clauses = [*_differences(one, other, parting), _ends(facts, one, other)]
    return f"{capital('; '.join(clauses))}.{_alone(one, other, parting)}"


def ending(parting: Parting, dt_s: float) -> list[tuple[int, str]]:
    """Return the step at which the first of the two trials has ended, with who that is; nothing
    where both do at once."""
    times = [(end.time_s, end.variant) for end in parting.trials if end.time_s is not None]
    if len(times) < 2 or times[0][0] == times[1][0]:
        return []
    time_s, variant = min(times)
    return [(control_steps(time_s, dt_s), f"{variant} has ended")]


def _missing(trial: Ended) -> str:
    what = f"{trial.variant} {where(trial.condition)}"
    if trial.status is None:
        return f"{what} did not run"
    return f"{what} failed{f' ({one_line(trial.error)})' if trial.error else ''}"


def _differences(one: Ended, other: Ended, parting: Parting) -> list[str]:
    """Return a clause for each kind: those that differ in the order of time, then the others."""
    order = list(DIFFERS)
    first = sorted(parting.first, key=lambda kind: (parting.first[kind].step, order.index(kind)))
    equal = [kind for kind in order if kind in parting.compared and kind not in first]
    if not parting.compared:
        return ["nothing was recorded of both trials that could be compared"]
    same = [f"no recorded {series(list(equal)).replace(' and ', ' or ')} differs"] if equal else []
    if not first:
        return same
    at = parting.first[first[0]]
    clauses = [_beginning(first[0], at, one, other)]
    for kind in first[1:]:
        late = parting.first[kind].time_s - at.time_s
        when = f"{_time(late)} s later " if late > 0 else ""
        clauses.append(f"{when}the {DIFFERS[kind]}{'' if when else ' at the same time'}")
        at = parting.first[kind]
    return clauses + same


def _beginning(kind: Kind, at: Difference, one: Ended, other: Ended) -> str:
    """Return the clause on the first difference of all, with both values, there and where they
    differ most."""
    name = in_words(at.name)
    if at.component is not None:
        name += f" ({at.part or f'component {at.component}'})"
    begin = f"at {_time(at.time_s)} s the"
    if kind == "reading":
        verb = "got" if at.delivered else "reads" if len(at.modules) == 1 else "read"
        what = f"{begin} {name} that the {series([*map(in_words, at.modules)])} {verb}"
    else:
        what = f"{begin} {DIFFERS[kind]}: {name}"
    of_unit = "" if at.unit in ("", "1") else f" {unit(at.unit)}"
    text = f"{what} is {_both(at.values, of_unit, one, other)}"
    if at.others:
        text += f" (and {counted(at.others, f'more {kind}')} differ{'s' * (at.others == 1)})"
    if at.most is not None:
        time_s, values = at.most
        text += f"; they differ most at {_time(time_s)} s: {_both(values, of_unit, one, other)}"
    return text


def _both(values: tuple[float, float], of_unit: str, one: Ended, other: Ended) -> str:
    """Return `3 m in old, 4 m in new`: neither is the right one."""
    places = f"in {one.variant}", f"in {other.variant}"
    if one.variant == other.variant:
        places = where(one.condition), where(other.condition)
    texts = _apart(values)
    return ", ".join(f"{text}{of_unit} {at}" for text, at in zip(texts, places, strict=True))


def _ends(facts: ComparisonFacts, one: Ended, other: Ended) -> str:
    first, second = (
        f"{'' if end.time_s is None else f' at {_time(end.time_s)} s'} "
        f"({ended(facts, end.status or '')})"
        for end in (one, other)
    )
    if first == second:
        return f"both ended{first}"
    if one.variant == other.variant:
        places = where(one.condition), where(other.condition)
        return f"it ended{first} {places[0]},{second} {places[1]}"
    return f"{one.variant} ended{first}, {other.variant}{second}"


def _alone(one: Ended, other: Ended, parting: Parting) -> str:
    """Return a sentence for each version that has modules of its own."""
    return "".join(
        f" Only {end.variant} has the module{'s' if len(modules) > 1 else ''} "
        f"{series([*map(in_words, modules)])}."
        for end, modules in zip((one, other), parting.alone, strict=True)
        if modules
    )


def _apart(values: tuple[float, float]) -> tuple[str, str]:
    """Return both values with the fewest digits with which they differ."""
    for digits in range(_LEAST, _MOST):
        one, other = (f"{value:.{digits}g}".replace("-", MINUS) for value in values)
        if one != other:
            return one, other
    return repr(values[0]), repr(values[1])


def _time(seconds: float) -> str:
    hundredths = f"{seconds:.2f}"
    return hundredths if abs(float(hundredths) - seconds) < 1e-6 else f"{seconds:.3f}"
