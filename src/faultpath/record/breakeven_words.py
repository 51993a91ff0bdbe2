"""What is said of the fault frequency: decided ranges only, and none that the family denies."""

import math
from collections.abc import Sequence

from faultpath.record.model import Effect, PathBreakEven
from faultpath.record.question import Question
from faultpath.record.words import where
from faultpath.statistics import Region

_WHOLE = 100
_SLACK = 1e-6
"""On a percentage that is a whole number but for rounding."""


def clause(question: Question, regions: Sequence[Region], correct: Effect, faulty: Effect) -> str:
    """Return who is decided to be ahead at which fault frequencies; empty for nobody anywhere.

    A region counts where it reaches an end (no fault, or the fault in every episode) at which the
    family detects an effect on the same side, away from floor and ceiling: so no sentence
    contradicts that on the path.
    """
    said: list[str] = []
    for region in regions:
        low = region.low <= 0.0 and correct.leads and region.sign == correct.sign
        high = region.high >= 1.0 and faulty.leads and region.sign == faulty.sign
        winner = question.repair if region.sign > 0 else question.baseline
        if low and high:
            return f"{winner} is ahead at every frequency"
        if high and region.low <= 0.0:
            said.append(
                f"{winner} is ahead where the fault is frequent; how rare it may be is not decided"
            )
        elif low and region.high >= 1.0:
            said.append(
                f"{winner} is ahead where the fault is rare; how frequent it may be is not decided"
            )
        elif high and first(region.low) < 100:
            said.append(f"{winner} is ahead from {first(region.low)} % on")
        elif low and last(region.high) > 0:
            said.append(f"{winner} is ahead up to {last(region.high)} %")
    return ", ".join(said)


def borne_out(regions: Sequence[Region], correct: Effect, faulty: Effect) -> list[Region]:
    """Return the regions that effects bear out to the end: what a table and a picture show."""
    kept: list[Region] = []
    for region in regions:
        low = region.low > 0.0 or (correct.leads and region.sign == correct.sign)
        high = region.high < 1.0 or (faulty.leads and region.sign == faulty.sign)
        inner = region.low > 0.0 and region.high < 1.0
        shown = last(region.high) > 0 and first(region.low) < _WHOLE
        if low and high and not inner and shown:
            kept.append(region)
    return kept


def first(frequency: float) -> int:
    """Return the first whole percentage at or above a frequency."""
    return math.ceil(100.0 * frequency - _SLACK)


def last(frequency: float) -> int:
    """Return the last whole percentage at or below a frequency."""
    return math.floor(100.0 * frequency + _SLACK)


def sentences(breaks: Sequence[PathBreakEven], effects: Sequence[Effect]) -> tuple[str, ...]:
    """Return one sentence on all paths, with those of which nothing is decided at its end."""
    if not breaks:
        return ()
    tested = {effect.path for effect in effects if effect.acted}
    decided = [each for each in breaks if each.words and each.path in tested]
    if not decided:
        return ("No fault frequency is decided at which either arm is ahead.",)
    clauses = [f"{where(each.path)}, {each.words}" for each in decided]
    text = f"By fault frequency: {'; '.join(clauses)}."
    silent = [where(each.path) for each in breaks if not each.words]
    if silent:
        text += f" No frequency is decided {' or '.join(silent)}."
    return (text,)
