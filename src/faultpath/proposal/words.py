"""What a plan says in sentences. Ranks compare point estimates, and the words say no more."""

from collections.abc import Iterator, Sequence

from faultpath.proposal.plan import Plan
from faultpath.proposal.sources import Candidate


def sentences(plan: Plan) -> tuple[str, ...]:
    """Return why the first source is first, what the plan leaves open, and what it will take."""
    return tuple(_sentences(plan))


def _sentences(plan: Plan) -> Iterator[str]:
    sized = [each for each in plan.candidates if each.fault]
    yield _first(plan, sized)
    more = [
        f"{each.name} ({_counted(len(each.consumers), 'consumer')}; it {each.unsized})"
        for each in plan.candidates
        if not each.fault
    ]
    if more:
        yield (
            f"Without an expected error, and so without a rank: {', '.join(more)}. Declare it, or "
            "give it with --fault."
        )
    if plan.repaired:
        yield f"Taken as changed by the repair: {_both(plan.repaired)}."
    else:
        yield (
            "Which module the repair changes cannot be seen from what the variants read: every "
            "module is struck alone all the same; --module names it."
        )
    if plan.unplanned:
        open_ = ", ".join(f"{name} ({why})" for name, why in plan.unplanned.items())
        yield f"The same audit is due, but cannot be planned without an expected error: {open_}."
    audited = {audit.name for audit in plan.study.audits}
    yield from (each.note for each in sized if each.name in audited and each.note)
    yield ("Each fault has one size and sign, and lasts; `faultpath map` covers both signs.")
    if len(audited) > 1:
        yield "Each audit decides by itself: no correction is made for their number."
    yield _cost(plan)


def _first(plan: Plan, sized: Sequence[Candidate]) -> str:
    first, *others = sized
    count = _counted(len(first.consumers), "consumer")
    if not others:
        return f"{first.name} ({count}) is the only source with an expected error: no rank is due."
    tied = [each for each in others if each.rank == first.rank]
    alike = [each for each in others if len(each.consumers) == len(first.consumers)]
    if not alike:
        return f"{first.name} comes first: {count}, more than any other source in the ranking."
    names = _both([each.name for each in (tied or alike)])
    if tied:
        equal = "and the same probe response" if first.response is not None else "and no probe"
        own = ", since the system runs a loop of its own" if not plan.probed else ""
        return (
            f"{first.name} and {names} tie: {count} each, {equal}{own}. {first.name} is audited "
            "first because it is declared first."
        )
    known = [each.response for each in alike if each.response is not None]
    open_ = [each.name for each in alike if each.response is None]
    moved = f"a probe response ({first.response:.3g})"
    if known:
        moved = f"the largest probe response ({first.response:.3g}, next {known[0]:.3g})"
    return (
        f"{first.name} comes first: {count}, as {names}, and {moved}"
        + (f"; none is known of {_both(open_)}" if open_ else "")
        + f". These are point estimates from {_counted(plan.probed, 'scene')}; no test compares "
        "them."
    )


def _cost(plan: Plan) -> str:
    timing = plan.timing
    took = " and ".join(f"{s:.2g} s with {name}" for name, s in timing.block_s.items())
    return (
        f"{plan.total} trials, about {_clock(timing.seconds)} with "
        f"{_counted(timing.workers, 'worker')}: estimated from one block of "
        f"{_counted(timing.scenes, 'scene')} under correct inputs, flown here once with each "
        f"variant ({took}), as if trials under faults took as long and workers never waited."
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
