"""The tables of a plan: sources in order, and the audits that are proposed."""

from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.tables import Table, line


def tables(plan: Plan) -> tuple[Table, Table]:
    """Return the uncertain sources in order, and the proposed audits, which run both variants."""
    ranks = [each.rank for each in plan.candidates]
    return (
        Table(
            title="Uncertain sources by rank",
            corner="source",
            columns=("read by", "expected error"),
            words=("read by", "expected error"),
            lines=tuple(
                line(
                    f"{each.rank}{'=' * (ranks.count(each.rank) > 1)} {each.name}",
                    "\n".join(each.consumers),
                    each.fault or "none known",
                )
                for each in plan.candidates
            ),
            notes=(
                "Order: number of consumers, then the larger probe response, one that is not known "
                "last; equal ones share a rank.",
            ),
        ),
        Table(
            title=f"Proposed: {plan.study.repair} against {plan.study.baseline}",
            corner="fault",
            columns=("why", "arms", "trials"),
            words=("why", "arms"),
            lines=tuple(
                line(
                    each.fault,
                    each.why,
                    "\n".join(
                        arm.path if arm.role == arm.path else f"{arm.path}, {arm.role}"
                        for arm in each.arms
                    ),
                    str(trials),
                )
                for each, trials in zip(plan.study.audits, plan.trials, strict=True)
            ),
        ),
    )
