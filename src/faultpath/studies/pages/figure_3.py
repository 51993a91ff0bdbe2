"""Figure 3: success over the calibration error, in free space on the selection library."""

from faultpath.studies.cells import SELECTION, Cell, Setting
from faultpath.studies.pages.table_2 import faults

FREE = Setting(library=SELECTION, environment="free-space")
MODELS = ("wm-a", "wm-a+dcc", "wm-u", "wm-u+dcc")
ERRORS = tuple(round(-0.3 + 0.05 * i, 2) for i in range(13))
QUICK_ERRORS = (-0.3, -0.1, 0.0, 0.1, 0.3)


def cell(variant: str, error: float) -> Cell:
    """Return a model under a calibration error in free space, seed 0."""
    return Cell(FREE, variant, faults(error), quick=error in QUICK_ERRORS)


CELLS = tuple(cell(model, error) for model in MODELS for error in ERRORS)
MEASUREMENTS = ()
