"""C33: from which fault frequency on each repair pays (paper, Table V)."""

from collections.abc import Callable
from dataclasses import dataclass

from faultpath.statistics import DirectionShares, break_even
from faultpath.studies.claims.differences import together
from faultpath.studies.claims.found import Found
from faultpath.studies.claims.rules import (
    CONFIRMED,
    FEW_FOR_POINTS,
    FEW_SCENES,
    REFUTED,
    Bound,
    Judged,
    less_than,
    more_than,
)
from faultpath.studies.claims.statement import Statement, Statements
from faultpath.studies.entries import MIN_SCENES
from faultpath.studies.pages import table_5
from faultpath.studies.results import Results

RARE = 0.025
"""Share of resamples beyond one end of a 95 % interval."""


@dataclass(frozen=True, kw_only=True)
class Crossing(Found):
    """A break-even frequency in percent, where the repair pays above it or always."""

    shares: DirectionShares
    """Share of the resamples in each direction."""
    never: bool
    """Whether the estimates favour the repair at no frequency."""


@dataclass(frozen=True)
class PaysFrom:
    """The repair pays from a frequency on that is within a bound."""

    bound: Bound

    def words(self, subject: str) -> str:
        """Return the statement."""
        return self.bound.words(subject)

    def judge(self, found: Crossing) -> Judged:
        """Answer by the bound; without such a frequency refute when resamples rarely have one."""
        if not found.enough:
            return FEW_SCENES
        if found.value is not None:
            return self.bound.judge(found)
        # Resamples in which neither arm is ahead speak for no direction.
        not_paying = found.shares.below + found.shares.never
        if not_paying >= 1 - RARE:
            return REFUTED
        return Judged("undecided", "pays from no frequency on")


@dataclass(frozen=True)
class NeverPays:
    """The repair is favoured at no frequency."""

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} does not exist: the repair pays at none"

    def judge(self, found: Crossing) -> Judged:
        """Confirm by the estimate of a run that is large enough; refute when resamples disagree."""
        if not found.enough:
            return FEW_SCENES
        if found.never:
            return CONFIRMED if found.speaks_by_estimate else FEW_FOR_POINTS
        if found.value is not None and found.range is None:
            return FEW_FOR_POINTS
        paying = found.shares.above + found.shares.below + found.shares.always
        return REFUTED if paying >= 1 - RARE else Judged("undecided")


def frequency(repair: str) -> Callable[[Results], Crossing]:
    """Return the break-even frequency of a repair of Table V."""
    correct_repair, correct, faulty_repair, faulty = table_5.REPAIRS[repair]

    def found(results: Results) -> Crossing:
        nominal, struck = together(results, (correct_repair, correct), (faulty_repair, faulty))
        even = break_even(nominal.draws, struck.draws)
        value = interval = None
        if even.direction in ("above", "always") and even.p_star is not None:
            value, interval = 100 * even.p_star, even.interval
        n_scenes = len(nominal.pairs.scenes)
        assert even.shares is not None
        return Crossing(
            value=value,
            interval=(100 * interval[0], 100 * interval[1])
            if interval and n_scenes >= MIN_SCENES
            else None,
            unit="percent",
            n_scenes=n_scenes,
            shares=even.shares,
            never=even.direction == "never",
        )

    return found


def _pays_from(repair: str, name: str, bound: Bound) -> Statement[Crossing]:
    subject = f"break-even frequency of {name}, in percent,"
    return Statement(subject, frequency(repair), PaysFrom(bound))


CLAIMS: dict[str, Statements] = {
    "C33": (
        _pays_from("WM-A", "WM-A+DCC", less_than(15)),
        _pays_from("WM-U", "WM-U+DCC", less_than(15)),
        _pays_from("GRU/reconstruction-only", "GRU+DCC, reconstruction-only", more_than(30)),
        Statement("break-even frequency of GRU+DCC, shared,", frequency("GRU/shared"), NeverPays()),
    ),
}
