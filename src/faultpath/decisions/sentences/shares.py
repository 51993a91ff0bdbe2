"""At which shares of faulty episodes, or of common causes, which version is ahead, in words."""

from typing import NamedTuple

from faultpath.decisions.effects import Effect
from faultpath.decisions.question import Question
from faultpath.decisions.sentences.wording import first, last
from faultpath.statistics.estimate import Region


class Shares(NamedTuple):
    """How a share between two effects is called."""

    every: str
    many: str
    """Where it is large, with what is not decided."""
    few: str


FREQUENCY = Shares(
    "at every frequency",
    "where the fault is frequent; how rare it may be is open",
    "where the fault is rare; how frequent it may be is open",
)
"""The share of episodes with the fault."""
BETA = Shares(
    "at every beta",
    "where most of its faults are common cause; how few may be is open",
    "where few of its faults are common cause; how many may be is open",
)
"""The beta factor: of the faults of a module, the share that reaches all modules at once."""


def shares(
    question: Question, regions: tuple[Region, ...], none: Effect, all_: Effect, words: Shares
) -> str:
    """Return who is decided to be ahead at which shares; empty for nobody anywhere.

    A region counts where it reaches an end (a share of none, or of all) at which the family
    detects an effect on the same side, away from floor and ceiling: so no sentence contradicts
    that under the condition.
    """
    clauses: list[str] = []
    for region in regions:
        low = region.low <= 0.0 and none.leads and region.sign == none.sign
        high = region.high >= 1.0 and all_.leads and region.sign == all_.sign
        ahead = f"{question.repair if region.sign > 0 else question.baseline} is ahead"
        if low and high:
            return f"{ahead} {words.every}"
        if high and region.low <= 0.0:
            clauses.append(f"{ahead} {words.many}")
        elif low and region.high >= 1.0:
            clauses.append(f"{ahead} {words.few}")
        elif high and first(region.low) < 100:
            clauses.append(f"{ahead} from {first(region.low)} % on")
        elif low and last(region.high) > 0:
            clauses.append(f"{ahead} up to {last(region.high)} %")
    return ", ".join(clauses)
