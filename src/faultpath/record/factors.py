"""A factorial as data: its arms, and what came of it."""

from typing import Literal

from faultpath.results import Result
from faultpath.statistics import Estimate, Sign

FactorialOf = Literal["baseline", "repair", "difference"]
OUTCOMES: tuple[FactorialOf, ...] = ("baseline", "repair", "difference")


class FactorialEffect(Result):
    """A main effect of one module, or an interaction of several, on success."""

    of: FactorialOf
    """Success of the baseline, of the repair, or repair minus baseline."""
    factors: tuple[str, ...]
    """Modules."""
    effect: Estimate
    """Percentage points."""
    sign: Sign
    """What the family of all effects of the factorial decides."""
    test: str
    p_value: float
    adjusted_p_value: float


class Factorial(Result):
    """The fault at every subset of the modules that read its source."""

    factors: tuple[str, ...]
    paths: tuple[str, ...]
    """Of the outcome table, one for each subset."""
    scenes: int = 0
    """Scenes that every arm has."""
    hypotheses: int = 0
    """Effects that share an error rate of 5 % of their own."""
    effects: tuple[FactorialEffect, ...] = ()
    words: tuple[str, ...]
