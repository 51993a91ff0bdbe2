"""Facts that the paper states, and how the project stands to each."""

from functools import cache
from typing import Literal, get_args

from faultpath.core.results import Frozen
from faultpath_paper.cells import data

Standing = Literal["as written", "our reading", "otherwise"]
STANDINGS: tuple[Standing, ...] = get_args(Standing)
SECTIONS: dict[str, str] = data("words.yaml")["sections"]
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
def groups(section: str = "") -> tuple[FactGroup, ...]:
    """Return the groups of `data/facts.yaml`, or those of a section, in the order of the paper."""
    every = (FactGroup.model_validate(entry) for entry in data("facts.yaml"))
    return tuple(group for group in every if section in ("", group.section))


def facts(section: str = "") -> tuple[Fact, ...]:
    """Return every fact, or those of a section."""
    return tuple(fact for group in groups(section) for fact in group.facts)
