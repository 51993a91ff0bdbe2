"""C33: from which fault frequency on each repair pays (paper, Table V)."""

from faultpath_paper.answers import StatementPart
from faultpath_paper.cells import Printed, published
from faultpath_paper.claims.rules import FEW_SCENES, REFUTED, Bound, Judged, by_point
from faultpath_paper.claims.statement import Statement, Statements, beside, size, stated
from faultpath_paper.detection import detection, enough, resampled
from faultpath_paper.pages import table_5
from faultpath_paper.quantities.differences import Crossing, crossing, greater_effect
from faultpath_paper.results import Results


def pays(name: str, repair: str, bound: Bound) -> Statement:
    """Return the statement that the frequency from which a repair pays meets a bound.

    `repair` is a key of `table_5.REPAIRS`.
    """
    words = bound.words.format(f"break-even frequency of {name}, in percent,")
    even = published("table_5_decision_record", repair)
    low, high = even["ci95"]
    paper = Printed(even["p_star_percent"], (low, high))

    def part(results: Results) -> StatementPart:
        tradeoff = crossing(results, table_5.REPAIRS[repair])
        n_scenes = tradeoff.correct.n_scenes
        judged = judge(tradeoff, bound)
        ends = None if tradeoff.value is None else tradeoff.interval
        return StatementPart(
            words=words,
            answer=judged.answer,
            estimate=tradeoff.value,
            interval=ends,
            unit="percent",
            reason=judged.reason,
            size=size(tradeoff.value, ends, n_scenes, paper, None),
            **beside(paper),
        )

    return Statement(words, paper, part)


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
        pays("WM-A+DCC", "WM-A", Bound(15, -1, strict=True)),
        pays("WM-U+DCC", "WM-U", Bound(15, -1, strict=True)),
        pays("GRU+DCC, reconstruction-only", "GRU/reconstruction-only", Bound(30, 1, strict=True)),
        stated(
            "the greater of the differences in success of GRU+DCC minus GRU, correct and shared,",
            greater_effect(table_5.REPAIRS["GRU/shared"]),
            by_point(-1),
        ),
    )
}
