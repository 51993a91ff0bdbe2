"""In the text on the mechanism: what errors say of success, and errors of the full prediction."""

from collections.abc import Callable, Iterable
from contextlib import suppress

import numpy as np

from faultpath.evidence import Measured, Measurement
from faultpath.report import wording
from faultpath.statistics import quantile_difference, spearman
from faultpath.studies.contrasts import attempt
from faultpath.studies.entries import (
    BLANK,
    difference,
    guarded,
    interval,
    mean_of_medians,
)
from faultpath.studies.notes import flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages import table_4
from faultpath.studies.pages.table_6 import acceleration_error, by_seed, position_error
from faultpath.studies.published import published
from faultpath.studies.results import NotRun, Results
from faultpath.tables import MISSING, Entry, Line, Table

TITLE = "What errors say of success, and errors of the full prediction"
NINE = tuple((method, path) for method in table_4.METHODS for path in table_4.PATHS)
"""Methods and interfaces of Table IV."""
CELLS = tuple(table_4.cell(method, path) for method, path in NINE)
MEASUREMENTS = tuple(
    measurement
    for measure in (acceleration_error, position_error)
    for method, path in NINE
    for measurement in by_seed(measure, method, path)
)


def build(results: Results) -> Built:
    """Return the tables of this page."""
    return _correlations(results), _errors(results)


def _correlations(results: Results) -> Table:
    paper = published("in_text", "spearman_success")
    rows = (
        ("Analytic acceleration error", "analytic_acceleration_error", acceleration_error),
        ("20-step position error", "position_error_20_step", position_error),
    )
    return Table(
        name="text-correlations",
        title="Rank correlation of errors with success (paper, Section VI)",
        columns=(f"Spearman, n = {paper['n']}",),
        lines=tuple(
            Line(label=label, entries=(_spearman(wording.plain(paper[key], 2), results, measure),))
            for label, key, measure in rows
        ),
        notes=(
            flown(results, CELLS),
            "Descriptive, over the nine cells of Table IV: mean success, and the mean over seeds "
            "of the median error.",
        ),
    )


@guarded
def _spearman(results: Results, measure: Callable[[str, str, int], Measurement]) -> Entry:
    success = [results.rate(table_4.cell(method, path)).value for method, path in NINE]
    errors = [mean_of_medians(results, by_seed(measure, method, path)) for method, path in NINE]
    value = spearman(np.array(errors), np.array(success)).value
    return Entry(text=MISSING if value is None else wording.plain(value, 2))


def _errors(results: Results) -> Table:
    rise = attempt(lambda: _rise(results), ("", ""))
    labels = ("GRU, shared minus reconstruction-only", "95 % interval")
    return Table(
        name="text-position-errors",
        title="Error of the full prediction with a reconstructed wind (paper, Section VI)",
        columns=("(0, 0) (cm)", "(+0.1, 0) (cm)", "(+0.1, +0.1) (cm)"),
        lines=(
            *(
                Line(
                    label=table_4.NAMES[method],
                    entries=tuple(_error("", results, method, path) for path in table_4.PATHS),
                )
                for method in table_4.METHODS
            ),
            *(
                Line(label=label, entries=(BLANK, BLANK, entry))
                for label, entry in zip(labels, rise, strict=True)
            ),
        ),
        notes=(
            "Position error 20 control steps ahead, on the windows of Table VI (a); mean over "
            "seeds of the median over windows. Columns: calibration error of the reconstruction "
            "and of the predictor. The paper says that no reduction from the isolated to the "
            "shared error is detected.",
            recorded(results, MEASUREMENTS),
            "Interval: 95 % percentile bootstrap of whole scenes.",
        ),
    )


@guarded
def _error(results: Results, method: str, path: str) -> Entry:
    error = mean_of_medians(results, by_seed(position_error, method, path))
    return Entry(text=wording.plain(100 * error))


def _rise(results: Results) -> tuple[Entry, Entry]:
    """Return the change of GRU's error from the isolated to the shared error, over its seeds."""
    shared, alone = (
        _measured(results, by_seed(position_error, "gru", path))
        for path in ("shared", "reconstruction-only")
    )
    seeds = sorted(set(shared) & set(alone))
    if not seeds:
        raise NotRun("a seed with both errors of the reconstruction")
    one, two = (
        np.stack([100 * found[seed].values for seed in seeds], axis=1) for found in (shared, alone)
    )
    estimate = quantile_difference(one, two, shared[seeds[0]].scenes, unit="cm")
    return difference(estimate), interval(estimate)


def _measured(results: Results, measurements: Iterable[Measurement]) -> dict[int, Measured]:
    """Return what was measured, by seed."""
    found: dict[int, Measured] = {}
    for measurement in measurements:
        with suppress(NotRun):
            found[measurement.seed] = results.measured(measurement)
    return found


PAGE = Page("text-mechanism", TITLE, CELLS, MEASUREMENTS, build)
