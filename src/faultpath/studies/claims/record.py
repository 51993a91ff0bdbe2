"""C33: from which fault frequency on each repair pays (paper, Table V)."""

from collections.abc import Callable
from dataclasses import dataclass

from faultpath.statistics import BreakEven, break_even
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
from faultpath.studies.pages import table_5
from faultpath.studies.quantities.differences import together
from faultpath.studies.quantities.found import MIN_SCENES, Found
from faultpath.studies.results import Results


@dataclass(frozen=True, kw_only=True)
class Crossing(Found):
    """A break-even frequency in percent, where the repair pays above it or always."""

    ahead: bool
    """Whether it is decided at some frequency that the repair is ahead."""
    behind: bool
    """Whether it is decided to be behind where every episode has the fault."""
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
        """Answer by the bound; refute a repair that ends up behind."""
        if not found.enough:
            return FEW_SCENES
        if found.value is not None:
            return self.bound.judge(found)
        return REFUTED if found.behind else Judged("undecided", "pays from no frequency on")


@dataclass(frozen=True)
class NeverPays:
    """The repair is favoured at no frequency."""

    def words(self, subject: str) -> str:
        """Return the statement."""
        return f"{subject} does not exist: the repair pays at none"

    def judge(self, found: Crossing) -> Judged:
        """Confirm by the estimate of a run that is large enough; refute where it is ahead."""
        if not found.enough:
            return FEW_SCENES
        if found.ahead:
            return REFUTED
        if found.never:
            return CONFIRMED if found.speaks_by_estimate else FEW_FOR_POINTS
        if found.value is not None and found.range is None:
            return FEW_FOR_POINTS
        return Judged("undecided")


def frequency(repair: str) -> Callable[[Results], Crossing]:
    """Return the break-even frequency of a repair of Table V."""
    correct_repair, correct, faulty_repair, faulty = table_5.REPAIRS[repair]

    def found(results: Results) -> Crossing:
        nominal, struck = together(results, (correct_repair, correct), (faulty_repair, faulty))
        even = break_even(nominal.draws, struck.draws)
        start, end = nominal.draws.value, struck.draws.value
        value = 100 * even.p_star if even.p_star is not None and start <= 0 < end else None
        if min(start, end) >= 0 < max(start, end):
            value = 0.0
        n_scenes = len(nominal.pairs.scenes)
        return Crossing(
            value=value,
            interval=_from(even) if value is not None and n_scenes >= MIN_SCENES else None,
            unit="percent",
            n_scenes=n_scenes,
            ahead=any(region.sign > 0 for region in even.regions),
            behind=any(region.sign < 0 and region.high == 1.0 for region in even.regions),
            never=max(start, end) <= 0 and min(start, end) < 0,
        )

    return found


def _from(even: BreakEven) -> tuple[float, float]:
    """Return the frequencies, in percent, from which on the repair may begin to pay.

    They begin where it is no longer decided to be behind, and end where it is decided to be ahead.
    """
    low = max((r.high for r in even.regions if r.sign < 0 and r.low == 0.0), default=0.0)
    high = min((r.low for r in even.regions if r.sign > 0 and r.high == 1.0), default=1.0)
    return 100 * low, 100 * high


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
