"""Table II: what calibration errors do to four models, and what uncertainty training recovers."""

from faultpath.evidence import Measurement
from faultpath.studies.cells import SEEDS, Cell, calibration
from faultpath.studies.pages.table_1 import COMMON, STILL

ERRORS = (-0.1, 0.0, 0.1)
PAIRS = (("wm-a+dcc", "wm-a"), ("wm-u+dcc", "wm-u"))
"""Repair and baseline."""


def faults(error: float) -> tuple[str, ...]:
    """Return the coupled calibration fault at every module; none for no error."""
    return (calibration(error),) if error else ()


def cell(variant: str, error: float) -> Cell:
    """Return a model under a calibration error."""
    return Cell(STILL, variant, faults(error), seeds=SEEDS)


def error_under(error: float) -> Measurement:
    """Return WM-A's 20-step position error on the common trajectories, seed 0."""
    return Measurement(
        recording=COMMON, quantity="position-error", subject="wm-a", faults=faults(error)
    )


CELLS = tuple(cell(model, error) for pair in PAIRS for model in pair for error in ERRORS)
MEASUREMENTS = tuple(map(error_under, ERRORS))
