"""Judgement of a system from the runs of a check: eight checks, each as data."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from faultpath.loop import Module
from faultpath.run.check.blocks import TRIALS, CheckRuns, coarsest, condition_of, gap_of
from faultpath.run.check.delivery import HELD, MOVED, delivery
from faultpath.run.check.results import (
    Checked,
    Compared,
    Diverged,
    Ends,
    NoneEnded,
    NoRoom,
    NotFinite,
    OrderMatters,
    OtherMagnitude,
    Problem,
    Reads,
    Repeated,
    Spans,
    Stopped,
    TwoNames,
    Unsteady,
    WholeNumbers,
)
from faultpath.run.deliveries import unproven, unread
from faultpath.run.findings import Unpaired
from faultpath.run.pairing import unlike
from faultpath.system.loop_system import LoopSystem
from faultpath.system.outcome import Outcome
from faultpath.system.system import System

ENOUGH = 20
"""So many scenes that all end alike: with 95 % confidence at most 14 % of scenes end otherwise."""
PAST_BELIEF = 1e30
"""No quantity of a plant is as large, whatever its unit."""
_SEVERAL = 10.0
"""A difference up to this multiple of what a last digit of the readings does may be rounding."""
_FAR = 100.0
"""A reading beyond this multiple of the typical magnitude is in another unit."""


def judged(runs: CheckRuns) -> tuple[Checked, ...]:
    """Judge all that was seen."""
    judges: dict[str, Callable[[str, CheckRuns], Checked]] = {
        "determinism": _determinism,
        "scene independence": _independence,
        "pairing": _pairing,
        "declared reads": _reads,
        "fault delivery": delivery,
        "shape and unit": _readings,
        "data files": lambda name, _: Checked(name),
    }
    outcomes = {name: run.outcomes for name, run in runs.firsts()}
    successes = tuple(
        (name, sum(row.status == "success" for row in rows), len(rows))
        for name, rows in outcomes.items()
    )
    ends = Ends(successes, sum(len(run.outcomes) for _, _, run in runs.under()))
    checks = [Checked(TRIALS, ends, remarks=without_room(outcomes))]
    for name, judge in judges.items():
        checks.append(judge(name, runs) if outcomes else Checked(name, unjudged="none ended"))
    for at, check in enumerate(checks):
        # Backwards: of several runs with the same error the first one names it.
        stopped = {
            run.error: Stopped(variant, condition_of(why), run.error, check.name == TRIALS)
            for (variant, why, _), run in reversed(runs.recorded.items())
            if run.fails == check.name and why not in ("tap", HELD, MOVED)
        }
        checks[at] = replace(check, failures=(*stopped.values(), *check.failures))
    if not outcomes:
        none = NoneEnded(tuple(check.name for check in checks[1:] if check.failures))
        checks[0] = replace(checks[0], summary=none, failures=checks[0].failures or (none,))
    return tuple(checks)


def without_room(outcomes: Mapping[str, Sequence[Outcome]]) -> tuple[NoRoom, ...]:
    """Return the variants that leave an audit no room, all that succeed and all that do not.

    `outcomes` are those of each variant without a fault. Fewer than `ENOUGH` scenes, and trials
    that failed, say nothing.
    """
    remarks: list[NoRoom] = []
    for success in (True, False):
        names = tuple(
            name
            for name, rows in outcomes.items()
            if len(rows) >= ENOUGH
            and not any(row.failed for row in rows)
            and all((row.status == "success") is success for row in rows)
        )
        if names:
            remarks.append(NoRoom(names, success, max(map(len, outcomes.values()))))
    return tuple(remarks)


def _determinism(name: str, runs: CheckRuns) -> Checked:
    """Check that the same scenes twice give the same bits."""
    failures = list[Problem]()
    for variant in runs.unsteady():
        between = runs.difference(variant, "anew", "alone") is not None
        within = runs.difference(variant, "repeated", "anew") is not None
        again = runs.difference(variant, "again")
        assert again is not None
        failures.append(Unsteady(variant, again, (between, within) if runs.apart else None))
    return Checked(name, Repeated(runs.apart), tuple(failures))


def _independence(name: str, runs: CheckRuns) -> Checked:
    """Check that a scene's result depends neither on the others nor on their order."""
    if runs.unsteady():
        return Checked(name, unjudged="order of unsteady")
    if len(runs.scenes) < 2:
        return Checked(name, unjudged="one scene")
    failures, remarks = list[OrderMatters](), list[OrderMatters]()
    for variant, first in runs.firsts():
        difference = runs.difference(variant, "part")
        if difference is None:
            continue
        gap, rounding = (gap_of(first, runs.get(variant, why)) for why in ("part", "rounded"))
        if gap > _SEVERAL * max(rounding, coarsest(first)):
            failures.append(OrderMatters(variant, difference, gap, "dependence"))
        elif math.isinf(gap):
            remarks.append(OrderMatters(variant, difference, gap, "last digit"))
        else:
            remarks.append(OrderMatters(variant, difference, gap, "rounding"))
    last_digit = any(remark.cause == "last digit" for remark in remarks)
    return Checked(
        name,
        failures=tuple(failures),
        remarks=tuple(remarks),
        unjudged="last digit" if last_digit else "",
    )


def _pairing(name: str, runs: CheckRuns) -> Checked:
    """Check that two treatments meet the same conditions in each scene."""
    if runs.unsteady():
        return Checked(name, unjudged="pairs of unsteady")
    firsts = list(runs.firsts())
    groups = [((variant, "correct inputs"), run) for variant, run in firsts]
    faulted = ((variant, runs.get(variant, "faulted")) for variant, _ in firsts)
    groups += [((variant, "a fault"), run) for variant, run in faulted if run.outcomes]
    (one, base), *others = groups
    unpaired = [
        Unpaired(first=one, second=two, scene=a.scene, seed=runs.seed, differences=causes)
        for two, run in others
        for a, b in zip(base.outcomes, run.outcomes, strict=True)
        if (causes := unlike(a, b))
    ]
    met = (o.met for _, run in firsts for o in run.outcomes if not o.failed)
    return Checked(name, Compared(len(groups)), (*Unpaired.first_of(unpaired), *unproven(met)))


def _reads(name: str, runs: CheckRuns) -> Checked:
    """Check that what is declared to be read is read."""
    counts = ((variant, count) for variant, run in runs.firsts() for count in run.counts)
    taps = sum(len({read.tap for read in run.reads}) for _, run in runs.firsts())
    remarks = other_names(runs.system, [variant for variant, _ in runs.firsts()])
    return Checked(name, Reads(taps), unread(counts), remarks)


def other_names(system: System, variants: Sequence[str]) -> tuple[TwoNames, ...]:
    """Return each two modules that stand for each other under two names.

    They write the same source in two variants and read the same channel.
    """
    if not isinstance(system, LoopSystem):
        return ()
    modules = {name: system.modules(name, None) for name in variants}
    remarks: dict[TwoNames, None] = {}
    for one, other in combinations(modules, 2):
        for first in _alone(modules[one], modules[other]):
            for second in _alone(modules[other], modules[one]):
                read = {port.channel for port in first.ports} & {p.channel for p in second.ports}
                if read and {*first.writes} & {*second.writes}:
                    names = (first.name, one), (second.name, other)
                    reads, writes = tuple(sorted(read)), tuple(sorted(first.writes))
                    remarks[TwoNames(*names, reads, writes)] = None
    return tuple(remarks)


def _alone(modules: Sequence[Module], others: Sequence[Module]) -> list[Module]:
    names = {module.name for module in others}
    return [module for module in modules if module.name not in names]


def _readings(name: str, runs: CheckRuns) -> Checked:
    """Check that sources give finite numbers of their unit; taps refuse other shapes themselves."""
    failures = list[Problem]()
    firsts = [(variant, "", run) for variant, run in runs.firsts()]
    lost: dict[str, NotFinite] = {}
    for variant, condition, run in (*firsts, *runs.under()):
        for read in run.reads:
            if read.lost:
                at = read.source, read.step, read.reader, read.lost
                lost.setdefault(read.source, NotFinite(variant, condition, *at))
    failures += lost.values()
    spans: dict[str, tuple[float, float]] = {}
    kinds: dict[str, set[str]] = {}
    for read in (read for _, _, run in firsts for read in run.reads):
        low, high = spans.get(read.source, (read.low, read.high))
        spans[read.source] = min(low, read.low), max(high, read.high)
        if read.valid_step >= 0:  # `before`, its value before the first step, is always a float
            kinds.setdefault(read.source, set()).add(read.dtype)
    shown: list[tuple[str, float, float, str]] = []
    for source in runs.system.interface.sources:
        low, high = spans.get(source.name, (math.inf, -math.inf))
        if low > high:
            continue
        shown.append((source.name, low, high, source.unit))
        whole = sorted(kind for kind in kinds.get(source.name, ()) if "int" in kind)
        if whole and (source.unit != "1" or any("float" in kind for kind in kinds[source.name])):
            failures.append(WholeNumbers(source.name, whole[0], source.unit))
        most = max(abs(low), abs(high))
        if source.scale and most and not 1 / _FAR <= most / source.scale <= _FAR:
            failures.append(OtherMagnitude(source.name, source.unit, source.scale, most))
    return Checked(name, Spans(tuple(shown)), tuple(failures), diverged(spans))


def diverged(spans: Mapping[str, tuple[float, float]]) -> tuple[Diverged, ...]:
    """Return each source whose readings, least and greatest, are past belief."""
    largest = {name: max(abs(low), abs(high)) for name, (low, high) in spans.items()}
    return tuple(Diverged(name, most) for name, most in largest.items() if most > PAST_BELIEF)
