"""The tables of a plan: sources in order, and the audits that are proposed."""

from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.tables import Line, Table, line


def by_rank(plan: Plan) -> Table:
    """Return the uncertain sources in order, with who reads them and how far they may err."""
    columns = ("read by", "expected error")
    notes = (
        "Order: number of consumers, then the larger probe response, one that is not known last; "
        "equal ones share a rank.",
    )
    lines: list[Line] = []
    for each in plan.candidates:
        mark = "=" if sum(other.rank == each.rank for other in plan.candidates) > 1 else ""
        said = ("\n".join(each.consumers), each.fault or "none known")
        lines.append(line(f"{each.rank}{mark} {each.name}", *said))
    return Table(
        title="Uncertain sources by rank",
        corner="source",
        columns=columns,
        words=columns,
        lines=tuple(lines),
        notes=notes,
    )


def by_audit(plan: Plan) -> Table:
    """Return the proposed audits with their arms, which run with both variants."""
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
                    arm.path if arm.role == arm.path else f"{arm.path}, {arm.role}"
                    for arm in each.arms
                ),
                str(trials),
            )
            for each, trials in zip(plan.study.audits, plan.trials, strict=True)
        ),
    )
