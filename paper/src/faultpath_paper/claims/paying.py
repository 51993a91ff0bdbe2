"""C33: from which fault frequency on each repair pays (paper, Table V)."""

from dataclasses import dataclass

from faultpath_paper.answers import StatementPart
from faultpath_paper.cells import Printed, published
from faultpath_paper.claims.rules import FEW_SCENES, REFUTED, Bound, Judged, by_point
from faultpath_paper.claims.statement import Statement, Statements, beside, size
from faultpath_paper.detection import detection, enough, resampled
from faultpath_paper.pages import table_5
from faultpath_paper.quantities.differences import Crossing, crossing, greater_effect
from faultpath_paper.results import Results


@dataclass(frozen=True)
class Pays:
    """The frequency from which the repair pays meets a bound."""

    name: str
    repair: str
    """Key of `table_5.REPAIRS`."""
    bound: Bound

    @property
    def paper(self) -> Printed:
        """The frequency that the paper prints, percent."""
        even = published("table_5_decision_record", self.repair)
        low, high = even["ci95"]
        return Printed(even["p_star_percent"], (low, high))

    @property
    def words(self) -> str:
        """The statement."""
        return self.bound.words.format(f"break-even frequency of {self.name}, in percent,")

    def part(self, results: Results) -> StatementPart:
        """Answer the statement from a run."""
        tradeoff = crossing(results, table_5.REPAIRS[self.repair])
        n_scenes = tradeoff.correct.n_scenes
        judged = judge(tradeoff, self.bound)
        ends = None if tradeoff.value is None else tradeoff.interval
        return StatementPart(
            words=self.words,
            answer=judged.answer,
            estimate=tradeoff.value,
            interval=ends,
            unit="percent",
            reason=judged.reason,
            size=size(tradeoff.value, ends, n_scenes, self.paper, None),
            **beside(self.paper),
        )


def judge(tradeoff: Crossing, bound: Bound) -> Judged:
    """Judge whether a break-even frequency meets a bound.

    Where the repair pays from no frequency on, it is refuted if the repair is detected behind under
    the fault.
    """
    if not enough(tradeoff.correct):
        return FEW_SCENES
    if tradeoff.value is not None:
        return bound.judge(tradeoff.value, tradeoff.interval, tradeoff.correct.n_scenes)
    behind = detection(resampled(tradeoff.faulty)) < 0
    return REFUTED if behind else Judged("undecided", "pays from no frequency on")


CLAIMS: dict[str, Statements] = {
    "C33": (
        Pays("WM-A+DCC", "WM-A", Bound(15, -1, strict=True)),
        Pays("WM-U+DCC", "WM-U", Bound(15, -1, strict=True)),
        Pays("GRU+DCC, reconstruction-only", "GRU/reconstruction-only", Bound(30, 1, strict=True)),
        Statement(
            "the greater of the differences in success of GRU+DCC minus GRU, correct and shared,",
            greater_effect(table_5.REPAIRS["GRU/shared"]),
            by_point(-1),
        ),
    )
}
