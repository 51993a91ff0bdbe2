"""Table V: from which fault frequency on each repair pays."""

from typing import Any

from faultpath.report import wording
from faultpath.statistics import BreakEven, break_even
from faultpath.studies.cells import Cell
from faultpath.studies.contrasts import attempt
from faultpath.studies.notes import INTERVALS, flown
from faultpath.studies.page import Built, Page
from faultpath.studies.pages import table_2, table_4
from faultpath.studies.published import published
from faultpath.studies.quantities.differences import together
from faultpath.studies.results import Contrast, Results
from faultpath.tables import Entry, Line, Table

REPAIRS: dict[str, tuple[Cell, ...]] = {
    "WM-A": tuple(
        table_2.cell(model, error) for error in (0.0, 0.1) for model in ("wm-a+dcc", "wm-a")
    ),
    "WM-U": tuple(
        table_2.cell(model, error) for error in (0.0, 0.1) for model in ("wm-u+dcc", "wm-u")
    ),
    **{
        f"GRU/{path}": tuple(
            table_4.cell(method, at) for at in ("correct", path) for method in ("gru+dcc", "gru")
        )
        for path in ("reconstruction-only", "shared")
    },
}
"""Repair and baseline under correct inputs, then both under the fault; keys as published."""

CELLS = tuple(cell for cells in REPAIRS.values() for cell in cells)
MEASUREMENTS = ()

TITLE = "From which fault frequency on each repair pays"
_PUBLISHED = "table_5_decision_record"
_LABELS = {
    "GRU/reconstruction-only": "GRU: reconstruction only",
    "GRU/shared": "GRU: shared with predictor",
}
NO_CROSSING = "no crossing"


def build(results: Results) -> Built:
    """Return Table V."""
    table = Table(
        name="table-5",
        title=f"{TITLE} (paper, Table V)",
        columns=("Δ0 (pp)", "Δf (pp)", "p* (%) [95 % interval]"),
        lines=tuple(_line(results, key, cells) for key, cells in REPAIRS.items()),
        notes=(
            flown(results, CELLS),
            "Success of the repair minus that of its baseline, under correct inputs (Δ0) and under "
            "e = +0.1 (Δf). p* = −Δ0/(Δf − Δ0) is the fault frequency at which the estimates break "
            "even; no crossing: at none. In brackets: frequencies at which it is not decided who "
            "is ahead.",
            "Predictors without wind, GRU at wind L3.",
            INTERVALS,
        ),
    )
    return (table,)


def _line(results: Results, key: str, cells: tuple[Cell, ...]) -> Line:
    paper = published(_PUBLISHED, key)
    texts = (
        wording.signed(paper["delta_0_pp"]),
        wording.signed(paper["delta_f_pp"]),
        _published_frequency(paper),
    )

    def entries() -> tuple[Entry, ...]:
        repair, baseline, faulty_repair, faulty_baseline = cells
        correct, faulty = together(results, (repair, baseline), (faulty_repair, faulty_baseline))
        result = break_even(correct.draws, faulty.draws)
        return _difference(correct), _difference(faulty), Entry(text=_frequency(result))

    return Line(label=_LABELS.get(key, key), entries=attempt(entries, texts))


def _difference(contrast: Contrast) -> Entry:
    text = wording.signed(contrast.success.value)
    return Entry(text=text, detected=bool(contrast.detected_sign))


def _frequency(result: BreakEven) -> str:
    return NO_CROSSING if result.kind == "empty" else wording.break_even(result).replace(" %", "")


def _published_frequency(paper: dict[str, Any]) -> str:
    if paper["p_star_percent"] is None:
        return NO_CROSSING
    low, high = paper["ci95"]
    return f"{paper['p_star_percent']} [{low}, {high}]"


PAGE = Page("table-5", TITLE, CELLS, MEASUREMENTS, build)
