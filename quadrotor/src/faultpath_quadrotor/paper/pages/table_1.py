"""Table I: prediction accuracy and closed-loop performance of four predictors."""

from faultpath.trials import Status
from faultpath_quadrotor.evidence.table import Measurement, Recording
from faultpath_quadrotor.paper.cells import SEEDS, Cell, Setting, published
from faultpath_quadrotor.paper.entries import (
    centimetres,
    ended,
    time,
)
from faultpath_quadrotor.paper.page import WINDOWS, Page, Row, TableSpec

STILL = Setting()
SEEN_THROUGH = Setting(others=(("clearance", "true"),))
"""Ground-truth clearance."""

DKI = Cell(STILL, "dki")
WM_A = Cell(STILL, "wm-a", seeds=SEEDS)
WM_U = Cell(STILL, "wm-u", seeds=SEEDS)
TRUE_PARAMETER = Cell(STILL, "true-parameter")
PREDICTORS = (DKI, WM_A, WM_U, TRUE_PARAMETER)

WM_A_SEEN = Cell(SEEN_THROUGH, "wm-a")
TRUE_PARAMETER_SEEN = Cell(SEEN_THROUGH, "true-parameter")
WITH_TRUE_CLEARANCE = (WM_A_SEEN, TRUE_PARAMETER_SEEN)


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


TITLE = "Prediction accuracy and closed-loop performance of four predictors"
_PAPER = published("table_1_prediction_accuracy")


def _row(key: str, cell: Cell) -> Row:
    paper = _PAPER[key]
    ends = (Status.SUCCESS, Status.CRASH, Status.TIMEOUT)
    return Row(
        key.partition("/")[0].replace("true", "True"),
        (
            centimetres(common_error(cell), paper["error_common_cm"]),
            centimetres(own_error(cell), paper["error_own_cm"]),
            *(ended(cell, status, paper[status.value]) for status in ends),
            time(cell, paper["time_s"]),
        ),
    )


PAGE = Page(
    "table-1",
    TITLE,
    (
        TableSpec(
            name="table-1",
            title=f"{TITLE} (paper, Table I)",
            columns=(
                "Error, common (cm)",
                "Error, own (cm)",
                "Success (%)",
                "Crash (%)",
                "Timeout (%)",
                "Time (s)",
            ),
            rows=(
                _row("DKI", DKI),
                _row("WM-A", WM_A),
                _row("WM-U", WM_U),
                _row("true-parameter", TRUE_PARAMETER),
                Row("With ground-truth clearance"),
                _row("WM-A/true-clearance", WM_A_SEEN),
                _row("true-parameter/true-clearance", TRUE_PARAMETER_SEEN),
            ),
            notes=(
                "{flown}",
                f"{WINDOWS} Common: on trajectories flown with the true-parameter model; own: on "
                "those that the row itself flew.",
                "Common: {recorded}",
                "Time: median over successful trials.",
            ),
        ),
    ),
)
