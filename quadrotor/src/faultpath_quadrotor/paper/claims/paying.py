"""C33: from which fault frequency on each repair pays (paper, Table V)."""

from dataclasses import dataclass

from faultpath.statistics.breakeven import break_even
from faultpath.statistics.contrast import MIN_SCENES
from faultpath.statistics.estimate import BreakEven
from faultpath_quadrotor.paper.answers import Part
from faultpath_quadrotor.paper.cells import Printed, published
from faultpath_quadrotor.paper.claims.rules import (
    CONFIRMED,
    FEW_FOR_POINTS,
    FEW_SCENES,
    REFUTED,
    Bound,
    Ends,
    Judged,
    points_decide,
    telling,
)
from faultpath_quadrotor.paper.claims.statement import Statements, beside, size
from faultpath_quadrotor.paper.pages import table_5
from faultpath_quadrotor.paper.quantities.differences import together
from faultpath_quadrotor.paper.results import Results


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """A break-even frequency in percent, where the repair pays above it or always."""

    value: float | None
    interval: Ends | None
    n_scenes: int
    ahead: bool
    """Whether it is decided at some frequency that the repair is ahead."""
    behind: bool
    """Whether it is decided to be behind where every episode has the fault."""
    never: bool
    """Whether the estimates favour the repair at no frequency."""

    def pays_within(self, bound: Bound) -> Judged:
        """Answer that the repair pays from a frequency on that meets `bound`; refute one that
        ends up behind."""
        if self.n_scenes < MIN_SCENES:
            return FEW_SCENES
        if self.value is not None:
            return bound.judge(self.value, self.interval, self.n_scenes)
        return REFUTED if self.behind else Judged("undecided", "pays from no frequency on")

    def pays_never(self) -> Judged:
        """Answer that the repair is favoured at no frequency.

        Confirmed by the estimate of a run that is large enough; refuted where it is ahead.
        """
        if self.n_scenes < MIN_SCENES:
            return FEW_SCENES
        if self.ahead:
            return REFUTED
        if self.never:
            return CONFIRMED if points_decide(self.n_scenes) else FEW_FOR_POINTS
        if self.value is not None and telling(self.interval, self.n_scenes) is None:
            return FEW_FOR_POINTS
        return Judged("undecided")


@dataclass(frozen=True)
class Pays:
    """The repair pays from a frequency on that meets a bound; without a bound, at none."""

    name: str
    repair: str
    """Key of `table_5.REPAIRS`."""
    bound: Bound | None = None

    @property
    def paper(self) -> Printed | None:
        """The frequency that the paper prints, percent."""
        even = published("table_5_decision_record", self.repair)
        if even["p_star_percent"] is None:
            return None
        low, high = even["ci95"]
        return Printed(even["p_star_percent"], (low, high))

    @property
    def words(self) -> str:
        """The statement."""
        subject = f"break-even frequency of {self.name},"
        if self.bound is None:
            return f"{subject} does not exist: the repair pays at none"
        return self.bound.words.format(f"{subject} in percent,")

    def part(self, results: Results) -> Part:
        """Answer it from a run."""
        found = crossing(results, self.repair)
        judged = found.pays_within(self.bound) if self.bound else found.pays_never()
        return Part(
            words=self.words,
            answer=judged.answer,
            estimate=found.value,
            interval=found.interval,
            unit="percent",
            reason=judged.reason,
            size=size(found.value, found.interval, found.n_scenes, self.paper, None),
            **beside(self.paper),
        )


def crossing(results: Results, repair: str) -> Crossing:
    """Return the break-even frequency of a repair of Table V."""
    correct_repair, correct, faulty_repair, faulty = table_5.REPAIRS[repair]
    nominal, faulted = together(results, (correct_repair, correct), (faulty_repair, faulty))
    even = break_even(nominal, faulted)
    start, end = nominal.value, faulted.value
    value = 100 * even.p_star if even.p_star is not None and start <= 0 < end else None
    if min(start, end) >= 0 < max(start, end):
        value = 0.0
    return Crossing(
        value=value,
        interval=_from(even) if value is not None and nominal.enough else None,
        n_scenes=nominal.n_scenes,
        ahead=any(region.sign > 0 for region in even.regions),
        behind=any(region.sign < 0 and region.high == 1.0 for region in even.regions),
        never=max(start, end) <= 0 and min(start, end) < 0,
    )


def _from(even: BreakEven) -> Ends:
    """Return the frequencies, in percent, from which on the repair may begin to pay.

    They begin where it is no longer decided to be behind, and end where it is decided to be ahead.
    """
    low = max((r.high for r in even.regions if r.sign < 0 and r.low == 0.0), default=0.0)
    high = min((r.low for r in even.regions if r.sign > 0 and r.high == 1.0), default=1.0)
    return 100 * low, 100 * high


CLAIMS: dict[str, Statements] = {
    "C33": (
        Pays("WM-A+DCC", "WM-A", Bound(15, -1, strict=True)),
        Pays("WM-U+DCC", "WM-U", Bound(15, -1, strict=True)),
        Pays("GRU+DCC, reconstruction-only", "GRU/reconstruction-only", Bound(30, 1, strict=True)),
        Pays("GRU+DCC, shared", "GRU/shared"),
    ),
}
