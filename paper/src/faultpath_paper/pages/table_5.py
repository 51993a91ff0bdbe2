"""Table V: from which fault frequency on each repair pays."""

from faultpath.report.sentences import wording
from faultpath.stats.breakeven import break_even
from faultpath_paper.cells import published
from faultpath_paper.entries import EntryGroup, Made, decided
from faultpath_paper.page import TableRow, page_of
from faultpath_paper.pages import table_2, table_4
from faultpath_paper.quantities.differences import Crossing, Repair, crossing
from faultpath_paper.results import Results

REPAIRS: dict[str, Repair] = {
    **{
        table_2.NAMES[baseline]: (
            table_2.cell(repair, 0.0),
            table_2.cell(baseline, 0.0),
            table_2.cell(repair, 0.1),
            table_2.cell(baseline, 0.1),
        )
        for repair, baseline in table_2.PAIRS
    },
    **{
        f"GRU/{condition}": (
            table_4.cell("gru+dcc", "correct"),
            table_4.cell("gru", "correct"),
            table_4.cell("gru+dcc", condition),
            table_4.cell("gru", condition),
        )
        for condition in ("reconstruction-only", "shared")
    },
}
"""Keys as published."""

NO_CROSSING = "no crossing"
ABOVE_NONE = "above none"


def _row(label: str, key: str) -> TableRow:
    paper = published("table_5_decision_record", key)
    cells = REPAIRS[key]

    def make(results: Results) -> Made:
        tradeoff = crossing(results, cells)
        inverted = break_even(tradeoff.correct, tradeoff.faulty)
        undecided = " and ".join(
            f"[{wording.last(low)}, {wording.first(high)}]" for low, high in inverted.pieces
        )
        effects = decided(tradeoff.correct), decided(tradeoff.faulty)
        return *effects, _crossing(tradeoff), undecided or "none"

    printed, p_star = NO_CROSSING, paper["p_star_percent"]
    if p_star is not None:
        low, high = paper["ci95"]
        printed = f"{p_star} [{low}, {high}]"
    effects = wording.signed(paper["delta_0_pp"]), wording.signed(paper["delta_f_pp"])
    return TableRow(label, (EntryGroup(make, (*effects, printed, ""), cells),))


def _crossing(tradeoff: Crossing) -> str:
    if tradeoff.value is None:
        return NO_CROSSING if tradeoff.behind_throughout else ABOVE_NONE
    low, high = tradeoff.interval or (None, None)
    ends = "" if low is None or high is None else f" [{low:.0f}, {high:.0f}]"
    return f"{tradeoff.value:.0f}{ends}"


PAGE = page_of(
    "table-5",
    _row("WM-A", "WM-A"),
    _row("WM-U", "WM-U"),
    _row("GRU: reconstruction only", "GRU/reconstruction-only"),
    _row("GRU: shared with predictor", "GRU/shared"),
)
