"""Facts that the paper states, and how the project stands to each."""

from functools import cache
from itertools import groupby
from typing import Literal, get_args

from faultpath.analyses.tables import Entry, Line, Table, line
from faultpath.core.results import Frozen
from faultpath_paper.cells import data

Standing = Literal["as written", "our reading", "otherwise"]
STANDINGS: tuple[Standing, ...] = get_args(Standing)
SECTIONS = {
    "IV-A": "IV-A, control architecture and information interface",
    "IV-B": "IV-B, interventions and evidence",
    "V": "V, prediction accuracy",
    "VI": "VI, the fidelity gap",
    "VII": "VII, the availability gap",
    "VIII": "VIII, discussion, with Table V",
    "Appendix": "Appendix, implementation",
}
"""Sections of the paper that state facts."""


class Fact(Frozen):
    """A statement of the paper about its set-up, its methods or its results."""

    number: int
    state: Standing
    """`our reading`: the paper is silent there, or can be read in several ways."""
    fact: str
    at: tuple[str, ...]
    """Places: a file of the quadrotor, or of another package from its name on, and a name in it."""
    ours: str = ""
    """Our way and the reason for it, unless it is as written."""


class FactGroup(Frozen):
    """Facts of one section on one subject."""

    section: Literal["IV-A", "IV-B", "V", "VI", "VII", "VIII", "Appendix"]
    heading: str
    facts: tuple[Fact, ...]


@cache
def groups() -> tuple[FactGroup, ...]:
    """Return every group of `data/facts.yaml`, in the order of the paper."""
    return tuple(FactGroup.model_validate(entry) for entry in data("facts.yaml"))


def facts() -> tuple[Fact, ...]:
    """Return every fact."""
    return tuple(fact for group in groups() for fact in group.facts)


def counted() -> Table:
    """Return how many facts have each standing, section by section."""
    lines: list[Line] = []
    for section, parts in groupby(groups(), lambda group: group.section):
        states = [fact.state for group in parts for fact in group.facts]
        lines.append(line(SECTIONS[section], *(str(states.count(state)) for state in STANDINGS)))
    states = [fact.state for fact in facts()]
    lines.append(line("All", *(str(states.count(state)) for state in STANDINGS)))
    return Table(corner="Section of the paper", columns=STANDINGS, lines=tuple(lines))


def listed(section: str) -> Table:
    """Return all facts of a section, each with its place in the code."""
    columns = ("The paper", "Here", "What ours is, and why", "Where")
    lines: list[Line] = []
    for group in groups():
        if group.section == section:
            lines.append(Line(label=group.heading))
            for fact in group.facts:
                state = Entry(text=fact.state, tone="bad" if fact.state == "otherwise" else "")
                entries = fact.fact, state, fact.ours, "; ".join(fact.at)
                lines.append(line(str(fact.number), *entries))
    return Table(corner="Fact", columns=columns, lines=tuple(lines), words=columns)
