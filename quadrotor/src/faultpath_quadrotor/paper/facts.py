"""What the paper states, fact by fact, and how the project stands to each."""

from functools import cache
from importlib.resources import files
from itertools import groupby
from typing import Literal, get_args

import yaml
from pydantic import BaseModel, ConfigDict

from faultpath.decisions.tables import Entry, Line, Table, line

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


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Fact(_Frozen):
    """Something that the paper says of its set-up, its methods or what it reports."""

    number: int
    state: Standing
    """`our reading`: the paper is silent there, or can be read in several ways."""
    fact: str
    at: tuple[str, ...]
    """Where it is: a file of this package, or of the engine from `faultpath/` on, and a name."""
    ours: str = ""
    """What is done and why, unless it is as written."""


class Group(_Frozen):
    """Facts of one section on one subject."""

    section: Literal["IV-A", "IV-B", "V", "VI", "VII", "VIII", "Appendix"]
    heading: str
    facts: tuple[Fact, ...]


@cache
def groups() -> tuple[Group, ...]:
    """Return every group of `paper/facts.yaml`, in the order of the paper."""
    text = (files("faultpath_quadrotor.paper") / "paper" / "facts.yaml").read_text("utf-8")
    return tuple(Group.model_validate(entry) for entry in yaml.safe_load(text))


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
            lines += [_row(fact) for fact in group.facts]
    return Table(corner="Fact", columns=columns, lines=tuple(lines), words=columns)


def _row(fact: Fact) -> Line:
    other = fact.state == "otherwise"
    state = Entry(text=fact.state, tone="bad" if other else "")
    return line(str(fact.number), fact.fact, state, fact.ours, "; ".join(fact.at))
