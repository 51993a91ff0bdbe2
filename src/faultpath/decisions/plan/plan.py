"""A plan: sources in order, the audits of a study, how many trials they take, and why."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Literal

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.decisions.dependent import DependentGroup, dependent_groups
from faultpath.decisions.plan.order import makers, ranked, recursion, repaired_modules
from faultpath.decisions.plan.probing import command_responses
from faultpath.decisions.plan.study import StudyAudit, StudyFile, arms_of
from faultpath.decisions.planning import Audit, plan_audit, two_variants
from faultpath.decisions.question import resolve
from faultpath.decisions.sentences.wording import counted, series
from faultpath.decisions.sources import Candidate, candidates
from faultpath.trials import Library, LoopSystem, System, SystemSpec, Variant
from faultpath.trials.question import PlanQuestion

PROBED_SCENES = 5
"""A probe is a look at where to begin, and no result."""
Note = Callable[[int, int], None]
"""Takes how many runs are done, and of how many."""


class Plan(Result):
    """Plan, as `faultpath plan --json` prints it."""

    format: Literal[1] = 1
    study: StudyFile
    candidates: tuple[Candidate, ...]
    """Ranked, those that have no fault and so no audit included."""
    repaired: tuple[str, ...]
    """Modules that the repair changes, as far as is known."""
    unplanned: dict[str, str]
    """Sources that the recursion leads to and that have no fault, each with why it leads there."""
    probed: int
    """Scenes of the probe; 0 where there was none."""
    trials: tuple[int, ...]
    """Number of trials of each audit."""
    dependent: tuple[DependentGroup, ...] = ()
    """Consumers that have one cause of failure in common, none of them with evidence yet."""


def make_plan(
    system: System,
    spec: SystemSpec,
    question: PlanQuestion,
    library: Library,
    note: Note = lambda done, total: None,
) -> Plan:
    """Rank, probe and lay the audits out.

    `UserError` for anything that `plan_audit` refuses, where no source has a fault, and for a
    variant that does not run.
    """
    variants = two_variants(system, question)
    uncertain = candidates(system, variants, question.fault)
    laid = {
        candidate.name: plan_audit(system, spec, question.audit_of(candidate.fault), library)
        for candidate in uncertain
        if candidate.fault
    }
    if not laid:
        raise _nothing_sized(system, uncertain)
    repaired = repaired_modules(system, *variants, question.module)
    scenes, probed = next(iter(laid.values())).study.scenes, 0
    if isinstance(system, LoopSystem) and len(laid) > 1:
        probed = min(len(scenes), PROBED_SCENES)
        responses = _responses(system, laid, variants, scenes[:probed], question.seeds[0], note)
        uncertain = [c.model_copy(update={"response": responses.get(c.name)}) for c in uncertain]
    order = ranked(uncertain)
    first = next(candidate for candidate in order if candidate.fault)
    reached = tuple(dict.fromkeys(c.partition(".")[0] for c in first.consumers))
    why = recursion(order, makers(system.interface, variants), (*repaired, *reached))
    why[first.name] = "first by rank" if first is order[0] else "first with an expected error"
    named = [candidate for candidate in order if candidate.fault and candidate.name in why]
    named.sort(key=lambda candidate: candidate is not first)
    sized = {candidate.name: candidate.fault for candidate in order if candidate.fault}
    return Plan(
        study=resolve(
            StudyFile,
            question,
            spec,
            library,
            scenes=len(scenes),
            audits=tuple(
                StudyAudit(
                    name=candidate.name,
                    fault=candidate.fault,
                    why=why[candidate.name],
                    arms=arms_of(laid[candidate.name], repaired),
                )
                for candidate in named
            ),
        ),
        candidates=order,
        repaired=repaired,
        unplanned={c.name: why[c.name] for c in order if c.name in why and not c.fault},
        probed=probed,
        trials=tuple(len(laid[c.name].study.arms()) * len(scenes) for c in named),
        dependent=tuple(
            group.model_copy(update={"fault": sized[group.name]}) if group.name in sized else group
            for group in dependent_groups(system.interface, variants)
        ),
    )


def _nothing_sized(system: System, uncertain: Sequence[Candidate]) -> UserError:
    """Return the error of a system of which no source has a fault."""
    if not uncertain:
        return UserError(
            f"{system.name}: neither variant reads a source that may err: nothing to plan."
        )
    why = "; ".join(f"{candidate.name} {candidate.unsized}" for candidate in uncertain)
    channel = next((c for candidate in uncertain for c in candidate.channels), "CHANNEL")
    return UserError(
        f"{system.name}: no source says how large its errors are ({why}): declare it in the "
        f"interface, or give the expected error, for example --fault {channel}:scale=1.1"
    )


def _responses(
    system: LoopSystem,
    laid: Mapping[str, Audit],
    variants: Sequence[Variant],
    scenes: Sequence[str],
    seed: int,
    note: Note,
) -> dict[str, float]:
    """Return how far a probe of each audit's fault moves the commands, at most, by its source."""
    responses: dict[str, float] = {}
    for done, variant in enumerate(variants):
        note(done, len(variants))
        arms = {
            (name, row.path): row.arm.faults
            for name, audit in laid.items()
            for row in audit.study.rows
            if row.variant == variant.name and row.arm.faults
        }
        moved = command_responses(system, variant.name, arms, scenes, seed)
        for (name, _), value in moved.items():
            responses[name] = max(value, responses.get(name, value))
    return responses


def sentences(plan: Plan) -> Iterator[str]:
    """Say why the first source is first, what the plan leaves open, and what it will take.

    Ranks compare point estimates, and the words say no more.
    """
    first, *others = plan.candidates
    tied = any(candidate.rank == first.rank for candidate in others)
    yield _first(plan)
    if not first.fault:
        audited = next(candidate.name for candidate in plan.candidates if candidate.fault)
        yield (
            f"{first.name} cannot be audited without an expected error; {audited} is the first in "
            "the ranking that has one."
        )
    elif tied:
        yield f"{first.name} is audited first: it has an expected error and is declared first."
    if unsized := [
        f"{candidate.name} ({candidate.unsized})"
        for candidate in plan.candidates
        if not candidate.fault
    ]:
        yield (
            f"Without an expected error, and so without an audit: {series(unsized)}. Declare it in "
            "the interface, or give it with --fault."
        )
    if plan.unplanned:
        due = "; ".join(f"{name} ({why})" for name, why in plan.unplanned.items())
        yield (
            "To audit next, once their errors are known, since repaired modules depend on them or "
            f"make them: {due}."
        )
    if plan.repaired:
        yield f"Taken as changed by the repair: {series(plan.repaired)}."
    else:
        yield (
            "Which module the repair changes cannot be seen: every module is faulted alone all the "
            "same; --module names it."
        )
    audits = {audit.name for audit in plan.study.audits}
    yield from (
        candidate.note
        for candidate in plan.candidates
        if candidate.name in audits and candidate.note
    )
    yield "Each fault has one size and sign, and lasts; `faultpath map` covers both signs."
    if len(audits) > 1:
        yield "The audits are separate tests: no correction is made for their number."
    yield f"{counted(sum(plan.trials), 'trial')} in all."


def _first(plan: Plan) -> str:
    """Say why the first source is first."""
    first, *others = plan.candidates
    count = counted(len(first.consumers), "reader")
    tied = [candidate.name for candidate in others if candidate.rank == first.rank]
    alike = [
        candidate.name for candidate in others if len(candidate.consumers) == len(first.consumers)
    ]
    if not others:
        return f"{first.name} ({count}) is the only uncertain source: no rank is due."
    if not alike:
        return f"{first.name} comes first: {count}, more than any other source."
    if tied:
        named = series([first.name, *tied])
        return f"{named} tie: {count} each, and nothing tells them apart."
    return (
        f"{first.name} comes first: {count}, as {series(alike)}, and its error moves the commands "
        f"most ({first.response:.3g} of their root mean square, a point estimate from "
        f"{counted(plan.probed, 'scene')} that no test compares)."
    )
