"""The tables of a plan: sources in order, and the audits that are proposed."""

from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.tables import Table, line


def tables(plan: Plan) -> tuple[Table, Table]:
    """Return the uncertain sources in order, and the proposed audits, which run both variants."""
    ranks = [candidate.rank for candidate in plan.candidates]
    return (
        Table(
            title="Uncertain sources by rank",
            corner="source",
            columns=("read by", "expected error"),
            words=("read by", "expected error"),
            lines=tuple(
                line(
                    f"{candidate.rank}{'=' * (ranks.count(candidate.rank) > 1)} {candidate.name}",
                    "\n".join(candidate.consumers),
                    candidate.fault or "none known",
                )
                for candidate in plan.candidates
            ),
            notes=(
                "Order: number of readers, then the larger probe response, one that is not known "
                "last; equal ones share a rank.",
            ),
        ),
        Table(
            title=f"Proposed: {plan.study.repair} against {plan.study.baseline}",
            corner="fault",
            columns=("why", "conditions", "trials"),
            words=("why", "conditions"),
            lines=tuple(
                line(
                    audit.fault,
                    audit.why,
                    "\n".join(
                        arm.path if arm.role == arm.path else f"{arm.path}, {arm.role}"
                        for arm in audit.arms
                    ),
                    str(trials),
                )
                for audit, trials in zip(plan.study.audits, plan.trials, strict=True)
            ),
        ),
    )
