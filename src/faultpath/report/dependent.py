"""The dependent-failure table: groups with one cause, what was flown of each, what is left open."""

from collections.abc import Sequence

from faultpath.decisions.dependent import (
    DependentGroup,
    Evidence,
    Taps,
    Way,
    dependent_groups,
    with_evidence,
)
from faultpath.decisions.model import SHARED
from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.plan.study import StudyFile, command
from faultpath.decisions.question import Question
from faultpath.decisions.tables import MISSING, Entry, Line, Table, line
from faultpath.report.inputs import ReportInput

DEPENDENT_MARK = b"Read at,Reaches further,Kind,Evidence"
NO_EVIDENCE = "no evidence"
_COLUMNS = ("Read at", "Reaches further", "Kind", "Evidence", "Difference, pp", "To run")
_NOTES = (
    "Terms of ISO 26262-1 and -9: the dependent failure initiator is an error of the source, the "
    "coupling factor why it reaches several places. What a source brings about at several modules "
    "is a common cause failure; what goes on through the output of a module, a cascading one.",
    "This is evidence for an analysis of dependent failures: which faults of sources that the "
    "interface declares were run in simulation, and what they show about these two variants. "
    "It is no such analysis itself, and shows neither independence nor freedom from interference: "
    "an effect that is not significant is not absent, and coupling that no interface declares "
    "(power, clocks, buses, shared code, the environment) is not seen. No compliance with ISO "
    "26262 or IEC 61508 follows.",
    "An audit counts for a group where its fault acts on that group alone. No evidence: no audit "
    "shown here has this condition. A dash: nothing is left to run.",
)


def of_runs(runs: Sequence[ReportInput], names: Sequence[str] = ()) -> Table | None:
    """Return the table of audits of the same variants, by the interface of the first of them.

    `None` where no two places depend on each other, and for audits of other systems or variants.
    """
    first = runs[0]
    for run in runs[1:]:
        others = (run.record.question.system, run.system.interface, run.system.variants)
        if others != (first.record.question.system, first.system.interface, first.system.variants):
            return None
    groups = dependent_groups(first.system.interface, first.system.variants)
    named = zip(names or [""] * len(runs), (run.record for run in runs), strict=True)
    return dependent_table(with_evidence(groups, named), first.record.question)


def in_short(plan: Plan) -> Table | None:
    """Return a line for each group of a plan, for a terminal."""
    columns = ("modules", "kind", "evidence")
    lines = tuple(
        line(group.name, "\n".join(group.modules), _kind(group.ways[-1]), NO_EVIDENCE)
        for group in plan.dependent
    )
    title, corner = "Dependent failures by source", "source"
    table = Table(title=title, corner=corner, columns=columns, words=columns, lines=lines)
    return table if lines else None


def dependent_table(
    groups: Sequence[DependentGroup], question: Question | StudyFile
) -> Table | None:
    """Return the table of groups, which before any trial have no evidence; `None` without any."""
    if not groups:
        return None
    lines: list[Line] = []
    for group in groups:
        fly = command(question, group.fault)
        lines.append(line(f"{group.name}: {group.coupling}"))
        for way in group.ways:
            for evidence in way.evidence or (None,):
                lines.append(_line(way, evidence, fly))
                fly = fly if lines[-1].entries[-1].text != fly else "the same audit"
    return Table(
        name="dependent-failures",
        title="Dependent failures",
        corner="Fault at",
        columns=_COLUMNS,
        words=tuple(column for column in _COLUMNS if column != "Difference, pp"),
        lines=tuple(lines),
        notes=_NOTES,
    )


def _line(way: Way, evidence: Evidence | None, fly: str) -> Line:
    label = "all of them (shared)" if way.path == SHARED else f"{way.path} alone"
    kind = _kind(way)
    places = ", ".join(dict.fromkeys(consumer for _, consumer in way.taps))
    further = ", ".join(way.passed_on) or "nothing"
    if evidence is None:
        return line(label, places, further, kind, NO_EVIDENCE, "none", fly)
    text = f"{evidence.run}: {evidence.said}" if evidence.run else evidence.said
    missed = f"not reached: {_by_channel(evidence.missed)}" if evidence.missed else ""
    return line(
        label,
        places,
        further,
        kind,
        Entry(text=text, aside="; ".join(filter(None, (evidence.fault, missed)))),
        Entry(text=evidence.difference or "none", detected=evidence.detected),
        fly if evidence.missed else MISSING,
    )


def _kind(way: Way) -> str:
    if way.path == SHARED:
        return "common cause and cascading" if way.passed_on else "common cause"
    return "cascading" if way.passed_on else "single"


def _by_channel(taps: Taps) -> str:
    of: dict[str, list[str]] = {}
    for channel, consumer in taps:
        of.setdefault(channel, []).append(consumer)
    return ", ".join(f"{channel} at {' and '.join(places)}" for channel, places in of.items())
