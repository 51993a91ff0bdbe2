"""From which fault frequency on a repair pays (paper, Table V), as a statement."""

import re

from faultpath_paper.answers import StatementPart
from faultpath_paper.cells import Printed, published
from faultpath_paper.claims.rules import BOUND, FEW_SCENES, REFUTED, Judged, Range
from faultpath_paper.claims.statement import Statement, beside, size
from faultpath_paper.detection import detection, enough, resampled
from faultpath_paper.pages import table_5
from faultpath_paper.quantities.differences import Crossing, crossing
from faultpath_paper.results import Results


def pays(words: str, repair: str) -> Statement:
    """Return the statement that the frequency from which a repair pays meets a bound.

    `repair` is a key of `table_5.REPAIRS`, and the bound is what the words end in.
    """
    (named,) = re.finditer(BOUND, words)
    even = published("table_5_decision_record", repair)
    low, high = even["ci95"]
    paper = Printed(even["p_star_percent"], (low, high))

    def part(results: Results) -> StatementPart:
        tradeoff = crossing(results, table_5.REPAIRS[repair])
        judged = judge(tradeoff, Range.of(*named.groups()))
        ends = None if tradeoff.value is None else tradeoff.interval
        return StatementPart(
            words=words,
            answer=judged.answer,
            estimate=tradeoff.value,
            interval=ends,
            unit="percent",
            reason=judged.reason,
            size=size(tradeoff.value, ends, tradeoff.correct.n_scenes, paper, None),
            **beside(paper),
        )

    return Statement(words, paper, part)


def judge(tradeoff: Crossing, bound: Range) -> Judged:
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
