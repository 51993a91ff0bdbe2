"""What the paper states, fact by fact, and how the project stands to each."""

from functools import cache
from itertools import groupby
from typing import Literal, get_args

from faultpath.core.results import Frozen
from faultpath.decisions.tables import Entry, Line, Table, line
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
    """Something that the paper says of its set-up, its methods or what it reports."""

    number: int
    state: Standing
    """`our reading`: the paper is silent there, or can be read in several ways."""
    fact: str
    at: tuple[str, ...]
    """Where it is: a file of this package, or of the engine from `faultpath/` on, and a name."""
    ours: str = ""
    """What is done and why, unless it is as written."""


class Group(Frozen):
    """Facts of one section on one subject."""

    section: Literal["IV-A", "IV-B", "V", "VI", "VII", "VIII", "Appendix"]
    heading: str
    facts: tuple[Fact, ...]


@cache
def groups() -> tuple[Group, ...]:
    """Return every group of `paper/facts.yaml`, in the order of the paper."""
    return tuple(Group.model_validate(entry) for entry in data("facts.yaml"))


def facts() -> tuple[Fact, ...]:
    """Return every fact."""
    return tuple(fact for group in groups() for fact in group.facts)


def counted() -> Table:
    """Return how many facts stand in which way, section by section."""
    lines: list[Line] = []
    for section, parts in groupby(groups(), lambda group: group.section):
        states = [fact.state for group in parts for fact in group.facts]
        lines.append(line(SECTIONS[section], *(str(states.count(each)) for each in STANDINGS)))
    states = [fact.state for fact in facts()]
    lines.append(line("All", *(str(states.count(each)) for each in STANDINGS)))
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
                said = fact.fact, state, fact.ours, "; ".join(fact.at)
                lines.append(line(str(fact.number), *said))
    return Table(corner="Fact", columns=columns, lines=tuple(lines), words=columns)
