"""What a plan says in sentences. Ranks compare point estimates, and the words say no more."""

from collections.abc import Iterator, Sequence

from faultpath.proposal.plan import Plan
from faultpath.proposal.sources import Candidate


def sentences(plan: Plan) -> tuple[str, ...]:
    """Return why the first source is first, what the plan leaves open, and what it will take."""
    return tuple(_sentences(plan))


def _sentences(plan: Plan) -> Iterator[str]:
    yield from _first(plan)
    if unsized := [each for each in plan.candidates if not each.fault]:
        reasons = dict.fromkeys(each.unsized for each in unsized)
        named = {why: [each.name for each in unsized if each.unsized == why] for why in reasons}
        told = "; ".join(
            f"{_both(names)} ({'each' if len(names) > 1 else 'it'} {why})"
            for why, names in named.items()
        )
        yield (
            f"Without an expected error, and so without an audit: {told}. Declare it in the "
            "interface, or give it with --fault."
        )
    if plan.unplanned:
        due = "; ".join(f"{name} ({why})" for name, why in plan.unplanned.items())
        yield f"Of these the recursion leads to the following, where the same audit is due: {due}."
    if plan.repaired:
        yield f"Taken as changed by the repair: {_both(plan.repaired)}."
    else:
        yield (
            "Which module the repair changes cannot be seen: every module is struck alone all the "
            "same; --module names it."
        )
    audited = {audit.name for audit in plan.study.audits}
    yield from (each.note for each in plan.candidates if each.name in audited and each.note)
    yield "Each fault has one size and sign, and lasts; `faultpath map` covers both signs."
    if len(audited) > 1:
        yield "Each audit decides by itself: no correction is made for their number."
    yield _cost(plan)


def _first(plan: Plan) -> Iterator[str]:
    """Say which source comes first, and which one is audited first where that is another."""
    first, *others = plan.candidates
    count = _counted(len(first.consumers), "consumer")
    tied = [each for each in others if each.rank == first.rank]
    alike = [each for each in others if len(each.consumers) == len(first.consumers)]
    names = _both([each.name for each in (tied or alike)]) if alike else ""
    if not others:
        yield f"{first.name} ({count}) is the only uncertain source: no rank is due."
    elif not alike:
        yield f"{first.name} comes first: {count}, more than any other source."
    elif tied:
        yield f"{first.name} and {names} tie: {count} each, {_equal(plan, first, tied)}"
    else:
        yield f"{first.name} comes first: {count}, as {names}, and {_moved(plan, first, alike)}"
    if not first.fault:
        audited = next(each.name for each in plan.candidates if each.fault)
        yield (
            f"{first.name} cannot be audited without an expected error; {audited} is the first in "
            "the ranking that has one."
        )


def _equal(plan: Plan, first: Candidate, tied: Sequence[Candidate]) -> str:
    equal = "and no probe" if first.response is None else "and the same probe response"
    if not first.fault:
        return f"{equal}."
    if not any(each.fault for each in tied):
        return f"{equal}. {first.name} is audited first because it alone has an expected error."
    own = ", since the system runs a loop of its own" if not plan.probed else ""
    return f"{equal}{own}. {first.name} is audited first because it is declared first."


def _moved(plan: Plan, first: Candidate, alike: Sequence[Candidate]) -> str:
    known = [each.response for each in alike if each.response is not None]
    unknown = [each.name for each in alike if each.response is None]
    found = f"a probe response ({first.response:.3g})"
    if known:
        found = f"the largest probe response ({first.response:.3g}, next {known[0]:.3g})"
    none = f"; none is known of {_both(unknown)}" if unknown else ""
    scenes = _counted(plan.probed, "scene")
    return f"{found}{none}. These are point estimates from {scenes}; no test compares them."


def _cost(plan: Plan) -> str:
    timing = plan.timing
    took = " and ".join(f"{s:.2g} s with {name}" for name, s in timing.block_s.items())
    part = f", of which {timing.flown} were flown here" if timing.flown < timing.scenes else ""
    return (
        f"{plan.total} trials, about {_clock(timing.seconds)} with "
        f"{_counted(timing.workers, 'worker')}: estimated from one block of "
        f"{_counted(timing.scenes, 'scene')} under correct inputs with each variant{part} "
        f"({took}), as if trials under faults took as long and workers never waited."
    )


def _clock(seconds: float) -> str:
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _both(names: Sequence[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
