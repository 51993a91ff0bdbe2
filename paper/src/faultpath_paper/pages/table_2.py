"""Table II: what calibration errors do to four models, and what uncertainty training recovers."""

from faultpath.report.sentences import wording
from faultpath_paper.cells import SEEDS, Cell, calibration, of_seed, published
from faultpath_paper.entries import EntryGroup, centimetres
from faultpath_paper.evidence.table import Measurement
from faultpath_paper.page import Rows, TableRow, page_of, rates
from faultpath_paper.pages.grid import Grid
from faultpath_paper.pages.table_1 import COMMON, STILL
from faultpath_paper.quantities.windows import quantile

ERRORS = (-0.1, 0.0, 0.1)
PAIRS = (("wm-a+dcc", "wm-a"), ("wm-u+dcc", "wm-u"))
"""Repair and baseline."""
NAMES = {"wm-a": "WM-A", "wm-a+dcc": "WM-A+DCC", "wm-u": "WM-U", "wm-u+dcc": "WM-U+DCC"}
"""Names in print."""


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


GRID = Grid(cell, NAMES, ERRORS, published("table_2_calibration"))
_FIRST = GRID.figures["WM-A_seed0"]


def _matched(repair: str, baseline: str) -> Rows:
    return (
        TableRow(f"Matched {NAMES[baseline]} comparison, success (%)"),
        GRID.rates(baseline),
        GRID.rates(repair),
        *GRID.differences(repair, baseline, " (pp)"),
    )


def _tail(error: float) -> EntryGroup:
    own = error_under(error)
    return EntryGroup(
        lambda results: (wording.plain(100 * quantile(results, own, 0.9)),), measurements=(own,)
    )


PAGE = page_of(
    "table-2",
    *_matched(*PAIRS[0]),
    *_matched(*PAIRS[1]),
    TableRow("WM-A seed 0: prediction and control"),
    TableRow(
        "Error, median (cm)",
        tuple(map(centimetres, map(error_under, ERRORS), _FIRST["error_cm"])),
    ),
    TableRow("Error, 90th percentile (cm)", tuple(map(_tail, ERRORS))),
    rates("Success (%)", (of_seed(cell("wm-a", error)) for error in ERRORS), _FIRST["success"]),
)
