"""What the documents show of the facts that the paper states."""

from collections.abc import Mapping
from pathlib import Path

from blocks import REFERENCE
from faultpath_quadrotor.paper.facts import SECTIONS, STANDINGS, counted, facts, listed

from faultpath.decisions.tables.escapes import markdown
from faultpath.decisions.tables.markdown import grid

PAGE = REFERENCE / "paper" / "facts.md"


def in_short() -> str:
    """Return the counts by section, and every fact that is otherwise with its reason."""
    every = facts()
    apart = [fact for fact in every if fact.state == "otherwise"]
    said = [
        f"- **{fact.number}.** *The paper:* {markdown(fact.fact)} *Here:* {markdown(fact.ours)}"
        for fact in apart
    ]
    where = f"{{reference}}/{PAGE.relative_to(REFERENCE)}"
    return "\n\n".join(
        [
            grid(counted()),
            f"Otherwise ([all {len(every)} facts]({where}), with their places in the code):",
            "\n".join(said),
        ]
    )


def pages() -> Mapping[Path, str]:
    """Return the page with every fact, by its path."""
    words = ", ".join(
        f"{sum(fact.state == state for fact in facts())} {state}" for state in STANDINGS
    )
    parts = [
        "# What the paper states, fact by fact",
        f"{len(facts())} facts: {words}. *As written*: what the paper says. *Our reading*: the "
        "paper is silent there, or can be read in several ways. *Otherwise*: something else. "
        "Places are files of `quadrotor/src/faultpath_quadrotor`, or of `src` from `faultpath/` "
        "on, each with a name in the file. Made from `paper/paper/facts.yaml` by `make docs`.",
    ]
    for section, title in SECTIONS.items():
        parts += [f"## {title}", grid(listed(section))]
    return {PAGE: "\n\n".join(parts) + "\n"}
