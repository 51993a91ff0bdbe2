"""In the text on the mechanism: what errors say of success, and errors of the full prediction."""

from faultpath.report import wording
from faultpath.studies.entries import BLANK, guarded, of_quantity
from faultpath.studies.notes import flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages import table_4
from faultpath.studies.pages.table_6 import acceleration_error, by_seed, position_error
from faultpath.studies.published import published
from faultpath.studies.quantities.found import Quantity, Undecidable
from faultpath.studies.quantities.summaries import rank_correlation
from faultpath.studies.quantities.windows import difference_of_quantiles, mean_of_medians
from faultpath.studies.results import Results
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


RANKED = tuple(
    rank_correlation(
        [(table_4.cell(method, path), by_seed(measure, method, path)) for method, path in NINE]
    )
    for measure in (acceleration_error, position_error)
)
"""Success against each of the two errors."""
RISE = difference_of_quantiles(
    by_seed(position_error, "gru", "shared"),
    by_seed(position_error, "gru", "reconstruction-only"),
)
"""GRU's full prediction, from the isolated to the shared error."""


def build(results: Results) -> Built:
    """Return the tables of this page."""
    return _correlations(results), _errors(results)


def _correlations(results: Results) -> Table:
    paper = published("in_text", "spearman_success")
    rows = (
        ("Analytic acceleration error", "analytic_acceleration_error", RANKED[0]),
        ("20-step position error", "position_error_20_step", RANKED[1]),
    )
    return Table(
        name="text-correlations",
        title="Rank correlation of errors with success (paper, Section VI)",
        columns=(f"Spearman, n = {paper['n']}",),
        lines=tuple(
            Line(label=label, entries=(_spearman(wording.plain(paper[key], 2), results, quantity),))
            for label, key, quantity in rows
        ),
        notes=(
            flown(results, CELLS),
            "Descriptive, over the nine cells of Table IV: mean success, and the mean over seeds "
            "of the median error.",
        ),
    )


@guarded
def _spearman(results: Results, quantity: Quantity) -> Entry:
    try:
        return Entry(text=wording.plain(quantity(results).value or 0.0, 2))
    except Undecidable:
        return Entry(text=MISSING)


def _errors(results: Results) -> Table:
    rise = of_quantity(results, RISE, times=100)
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


PAGE = Page("text-mechanism", TITLE, CELLS, MEASUREMENTS, build)
