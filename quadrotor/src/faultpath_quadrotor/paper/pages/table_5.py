"""Table V: from which fault frequency on each repair pays."""

from faultpath.decisions import wording
from faultpath.statistics.breakeven import break_even
from faultpath_quadrotor.paper.cells import Cell, published
from faultpath_quadrotor.paper.entries import Group, Made, decided
from faultpath_quadrotor.paper.page import INTERVALS, Page, Row, TableSpec
from faultpath_quadrotor.paper.pages import table_2, table_4
from faultpath_quadrotor.paper.quantities.differences import together
from faultpath_quadrotor.paper.results import Results

REPAIRS: dict[str, tuple[Cell, ...]] = {
    **{
        table_2.NAMES[baseline]: tuple(
            table_2.cell(model, error) for error in (0.0, 0.1) for model in (repair, baseline)
        )
        for repair, baseline in table_2.PAIRS
    },
    **{
        f"GRU/{path}": tuple(
            table_4.cell(method, at) for at in ("correct", path) for method in ("gru+dcc", "gru")
        )
        for path in ("reconstruction-only", "shared")
    },
}
"""Repair and baseline under correct inputs, then both under the fault; keys as published."""

TITLE = "From which fault frequency on each repair pays"
NO_CROSSING = "no crossing"


def _row(label: str, key: str) -> Row:
    paper = published("table_5_decision_record", key)
    repair, baseline, faulty_repair, faulty_baseline = cells = REPAIRS[key]

    def make(results: Results) -> Made:
        correct, faulty = together(results, (repair, baseline), (faulty_repair, faulty_baseline))
        found = break_even(correct, faulty)
        crossing = wording.break_even(found).replace(" %", "")
        return (
            decided(correct),
            decided(faulty),
            NO_CROSSING if found.kind == "empty" else crossing,
        )

    crossing, p_star = NO_CROSSING, paper["p_star_percent"]
    if p_star is not None:
        low, high = paper["ci95"]
        crossing = f"{p_star} [{low}, {high}]"
    texts = (wording.signed(paper["delta_0_pp"]), wording.signed(paper["delta_f_pp"]), crossing)
    return Row(label, (Group(make, texts, cells),))


PAGE = Page(
    "table-5",
    TITLE,
    (
        TableSpec(
            name="table-5",
            title=f"{TITLE} (paper, Table V)",
            columns=("Δ0 (pp)", "Δf (pp)", "p* (%) [95 % interval]"),
            rows=(
                _row("WM-A", "WM-A"),
                _row("WM-U", "WM-U"),
                _row("GRU: reconstruction only", "GRU/reconstruction-only"),
                _row("GRU: shared with predictor", "GRU/shared"),
            ),
            notes=(
                "{flown}",
                "Success of the repair minus that of its baseline, under correct inputs (Δ0) and "
                "under e = +0.1 (Δf). p* = −Δ0/(Δf − Δ0) is the fault frequency at which the "
                "estimates break even; no crossing: at none. In brackets: frequencies at which it "
                "is not decided who is ahead.",
                "Predictors without wind, GRU at wind L3.",
                INTERVALS,
            ),
        ),
    ),
)
