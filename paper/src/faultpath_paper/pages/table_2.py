"""Table II: what calibration errors do to four models, and what uncertainty training recovers."""

from faultpath.report.sentences import wording
from faultpath_paper.cells import SEEDS, Cell, Printed, calibration, of_seed, published
from faultpath_paper.entries import EntryGroup, centimetres, published_contrasts
from faultpath_paper.evidence.table import Measurement
from faultpath_paper.page import Page, Rows, TableRow, differences, rates, table
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


_PAPER = published("table_2_calibration")
_FIRST = _PAPER["WM-A_seed0"]


def paper_rate(model: str, error: float) -> float:
    """Return the success that the paper prints, percent."""
    return _PAPER[NAMES[model]][ERRORS.index(error)]


def paper_repair(baseline: str, error: float) -> Printed:
    """Return what the paper prints of repair minus baseline, pp."""
    name, at = NAMES[baseline], ERRORS.index(error)
    low, high = _PAPER[f"{name}_ci95"][at]
    return Printed(_PAPER[f"{name}_dcc_minus_baseline_pp"][at], (low, high))


def _rates(model: str) -> TableRow:
    return rates(NAMES[model], (cell(model, error) for error in ERRORS), _PAPER[NAMES[model]])


def _matched(repair: str, baseline: str) -> Rows:
    kinds = ("dcc_minus_baseline_pp", "ci95", "wins_losses")
    printed = (_PAPER[f"{NAMES[baseline]}_{kind}"] for kind in kinds)
    return (
        TableRow(f"Matched {NAMES[baseline]} comparison, success (%)"),
        _rates(baseline),
        _rates(repair),
        TableRow(f"{NAMES[repair]} minus {NAMES[baseline]} (pp)"),
        differences(
            ((cell(repair, error), cell(baseline, error)) for error in ERRORS),
            published_contrasts(*printed),
        ),
    )


def _tail(error: float) -> EntryGroup:
    own = error_under(error)
    return EntryGroup(
        lambda results: (wording.plain(100 * quantile(results, own, 0.9)),), measurements=(own,)
    )


PAGE = Page(
    "table-2",
    (
        table(
            "table-2",
            *_matched(*PAIRS[0]),
            *_matched(*PAIRS[1]),
            TableRow("WM-A seed 0: prediction and control"),
            TableRow(
                "Error, median (cm)",
                tuple(map(centimetres, map(error_under, ERRORS), _FIRST["error_cm"])),
            ),
            TableRow("Error, 90th percentile (cm)", tuple(map(_tail, ERRORS))),
            rates(
                "Success (%)", (of_seed(cell("wm-a", error)) for error in ERRORS), _FIRST["success"]
            ),
        ),
    ),
)
