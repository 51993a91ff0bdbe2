"""Table I: prediction accuracy and closed-loop performance of four predictors."""

from faultpath.evidence import Measurement, Recording
from faultpath.report import wording
from faultpath.studies.cells import SEEDS, Cell, Setting, of_seed
from faultpath.studies.entries import (
    centimetres,
    ended,
    guarded,
    of_quantity,
    printed,
    seed_range,
    time,
)
from faultpath.studies.notes import INTERVALS, WINDOWS, flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.published import published
from faultpath.studies.quantities.differences import time as time_difference
from faultpath.studies.quantities.windows import quantile
from faultpath.studies.results import Results
from faultpath.tables import MISSING, Entry, Line, Table
from faultpath.trials import Status

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

TITLE = "Prediction accuracy and closed-loop performance of four predictors"
_PUBLISHED = "table_1_prediction_accuracy"
_ROWS = {"DKI": DKI, "WM-A": WM_A, "WM-U": WM_U, "true-parameter": TRUE_PARAMETER}
_SEEN_ROWS = {
    "WM-A/true-clearance": WM_A_SEEN,
    "true-parameter/true-clearance": TRUE_PARAMETER_SEEN,
}


def build(results: Results) -> Built:
    """Return Table I, and the comparisons that the paper prints below it."""
    main = Table(
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
        lines=(
            *(_line(results, key, cell) for key, cell in _ROWS.items()),
            Line(label="With ground-truth clearance"),
            *(_line(results, key, cell) for key, cell in _SEEN_ROWS.items()),
        ),
        notes=(
            flown(results, map(of_seed, CELLS)),
            f"{WINDOWS} Common: on trajectories flown with the true-parameter model; own: on those "
            "that the row itself flew.",
            f"Common: {recorded(results, map(common_error, PREDICTORS))}",
            "Time: median over successful trials.",
        ),
    )
    below = Table(
        name="table-1-below",
        title="Span of errors, paired times and seeds (paper, Table I, below)",
        columns=("Value",),
        lines=_below(results),
        notes=(
            flown(results, PREDICTORS),
            "Times: median of the differences within jointly successful scenes, n of them, seed 0.",
            INTERVALS,
        ),
    )
    return main, below


def _line(results: Results, key: str, cell: Cell) -> Line:
    paper = published(_PUBLISHED, key)
    return Line(
        label=key.partition("/")[0].replace("true", "True"),
        entries=(
            centimetres(printed(paper["error_common_cm"]), results, common_error(cell)),
            centimetres(printed(paper["error_own_cm"]), results, own_error(cell)),
            ended(printed(paper["success"]), results, cell, Status.SUCCESS),
            ended(printed(paper["crash"]), results, cell, Status.CRASH),
            ended(printed(paper["timeout"]), results, cell, Status.TIMEOUT),
            time(printed(paper["time_s"], 2), results, cell),
        ),
    )


def _below(results: Results) -> tuple[Line, ...]:
    span = printed(published(_PUBLISHED, "error_span"))
    lines = [Line(label="Largest to smallest common error", entries=(_span(span, results),))]
    for key in ("DKI", "true-parameter"):
        paper = published(_PUBLISHED, "paired_time_minus_WM-A_s", key)
        text = f"{wording.signed(paper['median'], 2)} (n = {paper['n']})"
        found = _time(text, results, _ROWS[key])
        lines.append(Line(label=f"Time, {key} minus WM-A (s)", entries=(found,)))
    for key in ("WM-A", "WM-U"):
        low, high = published(_PUBLISHED, "success_range_over_seeds", key)
        found = seed_range(f"{low}–{high}", results, _ROWS[key])
        lines.append(Line(label=f"Success of {key} over seeds (%)", entries=(found,)))
    return tuple(lines)


@guarded
def _time(results: Results, cell: Cell) -> Entry:
    """Median difference in time over jointly successful scenes, s, with their number."""
    found = time_difference(cell, WM_A)(results)
    value, ends = of_quantity(results, lambda _: found, digits=2)
    return Entry(text=f"{value.text} {ends.text} (n = {found.n_scenes})")


@guarded
def _span(results: Results) -> Entry:
    errors = [quantile(results, common_error(cell)) for cell in PREDICTORS]
    return Entry(text=wording.plain(max(errors) / min(errors)) if min(errors) else MISSING)


PAGE = Page("table-1", TITLE, CELLS, MEASUREMENTS, build)
