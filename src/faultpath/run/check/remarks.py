"""Remarks on what may be a mistake: no room for an effect, divergence, two names of one role."""

from collections.abc import Mapping, Sequence
from itertools import combinations

from faultpath.core.text import listed
from faultpath.loop import Module
from faultpath.system.loop_system import LoopSystem
from faultpath.system.outcome import Outcome
from faultpath.system.system import System

ENOUGH = 20
"""So many scenes that all end alike: with 95 % confidence at most 14 % of scenes end otherwise."""
PAST_BELIEF = 1e30
"""No quantity of a plant is as large, whatever its unit."""

_ENDS = {
    True: (
        "succeed in all",
        "an audit could show no repair of such a baseline to be better under correct inputs: "
        "choose a library of harder scenes, or a stricter rule of success",
    ),
    False: (
        "succeed in none",
        "an audit could show no fault and no repair to make such a baseline worse: choose a "
        "library of easier scenes, or a milder rule of success",
    ),
}


def successes(outcomes: Mapping[str, Sequence[Outcome]]) -> str:
    """Return how many trials there were without a fault, and how many of each variant succeed."""
    total = sum(map(len, outcomes.values()))
    counts = (
        f"{name} {sum(row.status == 'success' for row in rows)} of {len(rows)}"
        for name, rows in outcomes.items()
    )
    successful = f"; successes: {', '.join(counts)}" if outcomes else ""
    return f"{total} under correct inputs{successful}"


def diverged(spans: Mapping[str, tuple[float, float]]) -> tuple[str, ...]:
    """Return a sentence for each source whose readings, least and greatest, are past belief."""
    return tuple(
        f"Source '{name}' gives readings of up to {max(abs(low), abs(high)):.3g}: look for a loop "
        "that is unstable without any fault."
        for name, (low, high) in spans.items()
        if max(abs(low), abs(high)) > PAST_BELIEF
    )


def without_room(outcomes: Mapping[str, Sequence[Outcome]]) -> tuple[str, ...]:
    """Return a sentence for each direction in which variants leave no room.

    `outcomes` are those of each variant without a fault. Fewer than `ENOUGH` scenes, and trials
    that failed, say nothing.
    """
    sentences: list[str] = []
    for success, (how, so) in _ENDS.items():
        names = [
            f"'{name}'"
            for name, rows in outcomes.items()
            if len(rows) >= ENOUGH
            and not any(row.failed for row in rows)
            and all((row.status == "success") is success for row in rows)
        ]
        if names:
            scenes = {len(rows) for rows in outcomes.values()}
            who = f"Variants {', '.join(names)}" if names[1:] else f"Variant {names[0]}"
            verb = how if names[1:] else how.replace("succeed", "succeeds")
            sentences.append(f"{who} {verb} of {max(scenes)} checked scenes without a fault; {so}.")
    return tuple(sentences)


def other_names(system: System, variants: Sequence[str]) -> tuple[str, ...]:
    """Return a sentence for each two modules that stand for each other under two names.

    They write the same source in two variants and read the same channel.
    """
    if not isinstance(system, LoopSystem):
        return ()
    modules = {name: system.modules(name, None) for name in variants}
    sentences: dict[str, None] = {}
    for one, other in combinations(modules, 2):
        for first in _alone(modules[one], modules[other]):
            for second in _alone(modules[other], modules[one]):
                read = {port.channel for port in first.ports} & {p.channel for p in second.ports}
                if read and {*first.writes} & {*second.writes}:
                    sentences[
                        f"Modules '{first.name}' of {one} and '{second.name}' of {other} read "
                        f"{listed(sorted(read))} and write {listed(sorted(first.writes))}; a fault "
                        "at either one alone reaches one of the two variants. To fault both, give "
                        f'them one name: @writes(..., name="{first.name}").'
                    ] = None
    return tuple(sentences)


def _alone(modules: Sequence[Module], others: Sequence[Module]) -> list[Module]:
    names = {module.name for module in others}
    return [module for module in modules if module.name not in names]
