"""In the text on the mechanism: what errors say of success, and errors of the full prediction."""

from faultpath.record import wording
from faultpath.studies.entries import Group, measured, of_quantity
from faultpath.studies.page import Page, Row, TableSpec
from faultpath.studies.pages import table_4
from faultpath.studies.pages.table_6 import acceleration_error, by_seed, position_error
from faultpath.studies.published import published
from faultpath.studies.quantities.summaries import rank_correlation
from faultpath.studies.quantities.windows import difference_of_quantiles

NINE = tuple((method, path) for method in table_4.METHODS for path in table_4.PATHS)
"""Methods and interfaces of Table IV."""
RANKED = tuple(
    rank_correlation(
        [(table_4.cell(method, path), by_seed(measure, method, path)) for method, path in NINE]
    )
    for measure in (acceleration_error, position_error)
)
"""Success against each of the two errors."""
_SHARED, _ALONE = (
    by_seed(position_error, "gru", path) for path in ("shared", "reconstruction-only")
)
RISE = difference_of_quantiles(_SHARED, _ALONE)
"""GRU's full prediction, from the isolated to the shared error."""

_PAPER = published("in_text", "spearman_success")


def _correlation(label: str, key: str, at: int) -> Row:
    group = Group(
        lambda results: (wording.plain(RANKED[at](results).value, 2),),
        (wording.plain(_PAPER[key], 2),),
        tuple(table_4.cell(method, path) for method, path in NINE),
        tuple(
            each
            for method, path in NINE
            for each in by_seed((acceleration_error, position_error)[at], method, path)
        ),
    )
    return Row(label, (group,))


def _errors(method: str) -> Row:
    subjects = (by_seed(position_error, method, path) for path in table_4.PATHS)
    return Row(
        table_4.NAMES[method],
        tuple(measured(subject, times=100, digits=1) for subject in subjects),
    )


PAGE = Page(
    "text-mechanism",
    "What errors say of success, and errors of the full prediction",
    (
        TableSpec(
            name="text-correlations",
            title="Rank correlation of errors with success (paper, Section VI)",
            columns=(f"Spearman, n = {_PAPER['n']}",),
            rows=(
                _correlation("Analytic acceleration error", "analytic_acceleration_error", 0),
                _correlation("20-step position error", "position_error_20_step", 1),
            ),
            notes=(
                "{flown}",
                "Descriptive, over the nine cells of Table IV: mean success, and the mean over "
                "seeds of the median error.",
            ),
        ),
        TableSpec(
            name="text-position-errors",
            title="Error of the full prediction with a reconstructed wind (paper, Section VI)",
            columns=("(0, 0) (cm)", "(+0.1, 0) (cm)", "(+0.1, +0.1) (cm)"),
            rows=(
                *map(_errors, table_4.METHODS),
                table_4.last_column(
                    "GRU, shared minus reconstruction-only",
                    of_quantity(RISE, measurements=(*_SHARED, *_ALONE), times=100),
                ),
            ),
            notes=(
                "Position error 20 control steps ahead, on the windows of Table VI (a); mean over "
                "seeds of the median over windows. Columns: calibration error of the "
                "reconstruction and of the predictor. The paper says that no reduction from the "
                "isolated to the shared error is detected.",
                "{recorded}",
                "Interval: 95 % percentile bootstrap of whole scenes.",
            ),
        ),
    ),
)
