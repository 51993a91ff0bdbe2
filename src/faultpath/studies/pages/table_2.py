"""Table II: what calibration errors do to four models, and what uncertainty training recovers."""

from collections.abc import Iterable

from faultpath.evidence import Measurement
from faultpath.studies.cells import SEEDS, Cell, calibration, of_seed
from faultpath.studies.contrasts import PublishedContrast, contrast_lines, published_contrasts
from faultpath.studies.entries import centimetres, printed, success
from faultpath.studies.notes import INTERVALS, WINDOWS, WINS, flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.table_1 import COMMON, STILL
from faultpath.studies.published import published
from faultpath.studies.results import Results
from faultpath.tables import Entry, Line, Table

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

TITLE = "Calibration errors on obstacles, and what uncertainty training recovers"
_PUBLISHED = "table_2_calibration"
NAMES = {"wm-a": "WM-A", "wm-a+dcc": "WM-A+DCC", "wm-u": "WM-U", "wm-u+dcc": "WM-U+DCC"}
"""Names in print."""


def build(results: Results) -> Built:
    """Return Table II."""
    lines = [line for pair in PAIRS for line in _matched(results, *pair)]
    table = Table(
        name="table-2",
        title=f"{TITLE} (paper, Table II)",
        columns=("e = −0.1", "e = 0", "e = +0.1"),
        lines=(*lines, *_prediction_and_control(results)),
        notes=(
            flown(results, CELLS),
            "Success in percent, mean over seeds; the paper prints these means without decimals.",
            WINS,
            INTERVALS,
            f"{WINDOWS} Windows: trajectories flown with the true-parameter model; "
            f"{recorded(results, MEASUREMENTS)}",
        ),
    )
    return (table,)


def published_repairs(baseline: str) -> tuple[PublishedContrast, ...]:
    """Return what the paper prints of repair minus baseline, one for each of `ERRORS`."""
    paper, name = published(_PUBLISHED), NAMES[baseline]
    return published_contrasts(
        paper[f"{name}_dcc_minus_baseline_pp"],
        paper[f"{name}_ci95"],
        paper[f"{name}_wins_losses"],
    )


def _matched(results: Results, repair: str, baseline: str) -> tuple[Line, ...]:
    name = NAMES[baseline]
    paper = published(_PUBLISHED)
    pairs = [(cell(repair, error), cell(baseline, error)) for error in ERRORS]
    return (
        Line(label=f"Matched {name} comparison, success (%)"),
        *(
            Line(
                label=NAMES[model],
                entries=_successes(
                    results, paper[NAMES[model]], (cell(model, error) for error in ERRORS)
                ),
            )
            for model in (baseline, repair)
        ),
        Line(label=f"{NAMES[repair]} minus {name} (pp)"),
        *contrast_lines(results, pairs, published_repairs(baseline)),
    )


def _prediction_and_control(results: Results) -> tuple[Line, ...]:
    paper = published(_PUBLISHED, "WM-A_seed0")
    medians = tuple(
        centimetres(printed(value), results, error_under(error))
        for value, error in zip(paper["error_cm"], ERRORS, strict=True)
    )
    tails = tuple(centimetres("", results, error_under(error), 0.9) for error in ERRORS)
    own = (of_seed(cell("wm-a", error)) for error in ERRORS)
    return (
        Line(label="WM-A seed 0: prediction and control"),
        Line(label="Error, median (cm)", entries=medians),
        Line(label="Error, 90th percentile (cm)", entries=tails),
        Line(label="Success (%)", entries=_successes(results, paper["success"], own)),
    )


def _successes(
    results: Results, papers: Iterable[float], cells: Iterable[Cell]
) -> tuple[Entry, ...]:
    return tuple(
        success(printed(paper), results, flown_cell)
        for paper, flown_cell in zip(papers, cells, strict=True)
    )


PAGE = Page("table-2", TITLE, CELLS, MEASUREMENTS, build)
