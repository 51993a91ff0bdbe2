"""Table I: prediction accuracy and closed-loop performance of four predictors."""

from faultpath.evidence import Measurement, Recording
from faultpath.studies.cells import SEEDS, Cell, Setting

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

CELLS = (*PREDICTORS, *WITH_TRUE_CLEARANCE)


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


MEASUREMENTS = (*map(common_error, PREDICTORS), *map(own_error, CELLS))

