"""What a plan says in sentences. Ranks compare point estimates, and the words say no more."""

from collections.abc import Iterator

from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.wording import counted, series


def sentences(plan: Plan) -> tuple[str, ...]:
    """Return why the first source is first, what the plan leaves open, and what it will take."""
    return tuple(_sentences(plan))


def _sentences(plan: Plan) -> Iterator[str]:
    yield from _first(plan)
    if unsized := [f"{each.name} ({each.unsized})" for each in plan.candidates if not each.fault]:
        yield (
            f"Without an expected error, and so without an audit: {series(unsized)}. Declare it in "
            "the interface, or give it with --fault."
        )
    if plan.unplanned:
        due = "; ".join(f"{name} ({why})" for name, why in plan.unplanned.items())
        yield f"Of these the recursion leads to the following, where the same audit is due: {due}."
    if plan.repaired:
        yield f"Taken as changed by the repair: {series(plan.repaired)}."
    else:
        yield (
            "Which module the repair changes cannot be seen: every module is faulted alone all the "
            "same; --module names it."
        )
    audited = {audit.name for audit in plan.study.audits}
    yield from (each.note for each in plan.candidates if each.name in audited and each.note)
    yield "Each fault has one size and sign, and lasts; `faultpath map` covers both signs."
    if len(audited) > 1:
        yield "Each audit decides by itself: no correction is made for their number."
    yield f"{counted(sum(plan.trials), 'trial')} in all."


def _first(plan: Plan) -> Iterator[str]:
    """Say which source comes first, and which one is audited first where that is another."""
    first, *others = plan.candidates
    count = counted(len(first.consumers), "consumer")
    tied = [each.name for each in others if each.rank == first.rank]
    alike = [each.name for each in others if len(each.consumers) == len(first.consumers)]
    if not others:
        yield f"{first.name} ({count}) is the only uncertain source: no rank is due."
    elif not alike:
        yield f"{first.name} comes first: {count}, more than any other source."
    elif tied:
        named = series([first.name, *tied])
        yield f"{named} tie: {count} each, and nothing tells them apart."
    else:
        yield (
            f"{first.name} comes first: {count}, as {series(alike)}, and the largest known probe "
            f"response ({first.response:.3g}), a point estimate from "
            f"{counted(plan.probed, 'scene')} that no test compares."
        )
    audited = next(each.name for each in plan.candidates if each.fault)
    if not first.fault:
        yield (
            f"{first.name} cannot be audited without an expected error; {audited} is the first in "
            "the ranking that has one."
        )
    elif tied:
        yield f"{first.name} is audited first: it has an expected error and is declared first."
