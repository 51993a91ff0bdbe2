"""The tables of a plan: sources in order, and the audits that are proposed."""

from faultpath.proposal.plan import Plan
from faultpath.proposal.sources import Candidate
from faultpath.tables import MISSING, Line, Table, line


def by_rank(plan: Plan) -> Table:
    """Return the uncertain sources in order: who reads them, and how far they move commands."""
    asked = plan.study
    columns = ("read by", "expected error", asked.baseline, asked.repair)
    notes = ["Order: number of consumers, then the larger probe response; equal ones share a rank."]
    if plan.probed:
        notes.append(
            f"Under each variant: its probe response, the median change of its commands under the "
            f"expected error, as a fraction of their root mean square, over {plan.probed} scenes; "
            "the largest among the paths of the error, which is named."
        )
    return Table(
        title="Uncertain sources, the one to audit first in front",
        corner="source",
        columns=columns,
        words=columns[:2],
        lines=tuple(_source(plan, each) for each in plan.candidates),
        notes=tuple(notes),
    )


def _source(plan: Plan, each: Candidate) -> Line:
    alike = sum(other.rank == each.rank for other in plan.candidates) > 1
    rank = MISSING if each.rank is None else f"{each.rank}{'=' if alike else ''}"
    variants = (plan.study.baseline, plan.study.repair)
    return line(
        f"{rank} {each.name}",
        "\n".join(each.consumers),
        each.fault or "none declared",
        *(_largest(each.responses.get(variant, {})) for variant in variants),
    )


def _largest(responses: dict[str, float]) -> str:
    if not responses:
        return MISSING
    path, found = max(responses.items(), key=lambda each: each[1])
    return f"{found:.3g} ({path})"


def by_audit(plan: Plan) -> Table:
    """Return the proposed audits with their arms, which fly with both variants."""
    columns = ("why", "arms", "trials")
    return Table(
        title=f"Proposed: {plan.study.repair} against {plan.study.baseline}",
        corner="fault",
        columns=columns,
        words=columns[:2],
        lines=tuple(
            line(
                each.fault,
                each.why,
                "\n".join(
                    arm.path if arm.role in (arm.path, "attribution") else f"{arm.path}, {arm.role}"
                    for arm in each.arms
                ),
                str(trials),
            )
            for each, trials in zip(plan.study.audits, plan.trials, strict=True)
        ),
        notes=("Arms that an audit shares with the first one fly once.",),
    )
