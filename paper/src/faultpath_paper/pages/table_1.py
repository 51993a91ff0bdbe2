"""Table I: prediction accuracy and closed-loop performance of four predictors."""

from faultpath.report.sentences import wording
from faultpath.system import Status
from faultpath_paper.cells import SEEDS, Cell, Setting, of_seed, published
from faultpath_paper.entries import (
    BLANK,
    EntryGroup,
    Made,
    centimetres,
    ended,
    interval_of,
    printed,
    time,
)
from faultpath_paper.evidence.table import Measurement, Recording
from faultpath_paper.page import Page, TableRow, table
from faultpath_paper.quantities import differences
from faultpath_paper.results import Results

STILL = Setting()
SEEN_THROUGH = Setting(others=(("clearance", "true"),))
"""Ground-truth clearance."""

CELLS = {
    "DKI": Cell(STILL, "dki"),
    "WM-A": Cell(STILL, "wm-a", seeds=SEEDS),
    "WM-U": Cell(STILL, "wm-u", seeds=SEEDS),
    "true-parameter": Cell(STILL, "true-parameter"),
    "WM-A/true-clearance": Cell(SEEN_THROUGH, "wm-a"),
    "true-parameter/true-clearance": Cell(SEEN_THROUGH, "true-parameter"),
}
"""Cells by their keys as published."""
PREDICTORS = DKI, WM_A, WM_U, TRUE_PARAMETER = tuple(CELLS.values())[:4]
WITH_TRUE_CLEARANCE = tuple(CELLS.values())[4:]
KEYS = {cell: key for key, cell in CELLS.items()}


def recording(cell: Cell) -> Recording:
    """Return the flights of a cell's first seed, recorded."""
    assert not cell.faults
    return Recording(
        library=cell.setting.library, variant=cell.variant, options=cell.setting.options
    )


COMMON = recording(TRUE_PARAMETER)
"""Common trajectories: flown with the true-parameter model."""


def common_error(cell: Cell) -> Measurement:
    """Return the 20-step position error of a cell's predictor on the common trajectories."""
    return Measurement(recording=COMMON, quantity="position-error", subject=cell.variant)


def own_error(cell: Cell) -> Measurement:
    """Return the same on the trajectories that the cell itself flew."""
    return Measurement(recording=recording(cell), quantity="position-error", subject=cell.variant)


PAPER = published("table_1_prediction_accuracy")


def _row(cell: Cell) -> TableRow:
    paper = PAPER[KEYS[cell]]
    ends = (Status.SUCCESS, Status.CRASH, Status.TIMEOUT)
    return TableRow(
        KEYS[cell].partition("/")[0].replace("true", "True"),
        (
            centimetres(common_error(cell), paper["error_common_cm"]),
            centimetres(own_error(cell), paper["error_own_cm"]),
            *(ended(cell, status, paper[status.value]) for status in ends),
            time(cell, paper["time_s"]),
        ),
    )


def _slower(cell: Cell) -> EntryGroup:
    """Return a predictor's time minus WM-A's where both succeed, with the number of scenes."""
    paper = PAPER["paired_time_minus_WM-A_s"][KEYS[cell]]
    pair = cell, of_seed(WM_A)

    def make(results: Results) -> Made:
        effect = differences.time(*pair)(results)
        return wording.signed(effect.value, 2), interval_of(effect, 2), str(effect.n_scenes)

    return EntryGroup(make, (wording.signed(paper["median"], 2), "", printed(paper["n"])), pair)


def _over_seeds(cell: Cell) -> EntryGroup:
    """Return the least and the most success of a model's seeds, percent."""

    def make(results: Results) -> Made:
        rates = [results.rate(of_seed(cell, seed)).value for seed in results.seeds(cell)]
        return (_range(min(rates), max(rates)),)

    return EntryGroup(make, (_range(*PAPER["success_range_over_seeds"][KEYS[cell]]),), (cell,))


def _range(least: float, most: float) -> str:
    return f"{wording.plain(least, 0)} to {wording.plain(most, 0)}"


PAGE = Page(
    "table-1",
    (
        table(
            "table-1",
            *map(_row, PREDICTORS),
            TableRow("With ground-truth clearance"),
            *map(_row, WITH_TRUE_CLEARANCE),
        ),
        table(
            "table-1b",
            TableRow("DKI", (_slower(DKI), BLANK)),
            TableRow("WM-A", (BLANK, BLANK, BLANK, _over_seeds(WM_A))),
            TableRow("WM-U", (BLANK, BLANK, BLANK, _over_seeds(WM_U))),
            TableRow("True-parameter", (_slower(TRUE_PARAMETER), BLANK)),
        ),
    ),
)
