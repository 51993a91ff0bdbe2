"""Table VI: how reconstruction bias and calibration error compensate, and the negative offset."""

from collections.abc import Callable, Iterable

from faultpath.evidence import Measurement
from faultpath.report import wording
from faultpath.studies.cells import Cell, calibration
from faultpath.studies.contrasts import PublishedContrast, contrast_entries
from faultpath.studies.entries import BLANK, guarded, printed, success
from faultpath.studies.notes import flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.table_1 import recording
from faultpath.studies.pages.table_4 import ERROR, METHODS, NAMES, PATHS, WINDY
from faultpath.studies.published import published
from faultpath.studies.quantities.windows import mean_of_medians
from faultpath.studies.results import Results
from faultpath.tables import Entry, Line, Table

INTERFACES: dict[str, tuple[str, ...]] = {
    "correct": PATHS["correct"],
    "reconstruction-only": PATHS["reconstruction-only"],
    "predictor-only": (calibration(ERROR, "predictor"),),
    "shared": PATHS["shared"],
}
"""(e_R, e_P) = (0, 0), (+0.1, 0), (0, +0.1), (+0.1, +0.1)."""

NEGATIVE: dict[str, tuple[str, ...]] = {
    "correct": (),
    "reconstruction-only": (calibration(-ERROR, "reconstruction"),),
    "shared": (calibration(-ERROR),),
}
"""(e_R, e_P) = (0, 0), (-0.1, 0), (-0.1, -0.1)."""

WINDOWS = recording(Cell(WINDY, "gru"))
"""Common windows: recorded with the reference reconstruction of seed 0 under correct inputs."""


def seeds(method: str) -> tuple[int, ...]:
    """Return the seeds of a method: the observer learns nothing."""
    return (0,) if method == "dob" else (0, 1, 2)


def acceleration_error(method: str, interface: str, seed: int) -> Measurement:
    """Return the analytic acceleration error of a method."""
    return _measure("acceleration-error", method, interface, seed)


def wind_term_error(method: str, interface: str, seed: int) -> Measurement:
    """Return the error of the wind's part of that acceleration alone."""
    return _measure("wind-term-error", method, interface, seed)


def position_error(method: str, interface: str, seed: int) -> Measurement:
    """Return the 20-step position error of the predictor with a method's wind."""
    return _measure("position-error", method, interface, seed)


def negative(method: str, path: str) -> Cell:
    """Return a method under the negative offset, seed 0."""
    return Cell(WINDY, method, NEGATIVE[path])


def _measure(quantity: str, method: str, interface: str, seed: int) -> Measurement:
    return Measurement.model_validate(
        {
            "recording": WINDOWS,
            "quantity": quantity,
            "subject": method,
            "seed": seed,
            "faults": INTERFACES[interface],
        }
    )


CELLS = tuple(negative(method, path) for method in ("gru", "gru+dcc") for path in NEGATIVE)
MEASUREMENTS = (
    *(
        acceleration_error(method, interface, seed)
        for method in METHODS
        for interface in INTERFACES
        for seed in seeds(method)
    ),
    *(
        wind_term_error("gru", interface, seed)
        for interface in ("reconstruction-only", "shared")
        for seed in seeds("gru")
    ),
    *(
        position_error(method, interface, seed)
        for method in METHODS
        for interface in PATHS
        for seed in seeds(method)
    ),
)

TITLE = "How reconstruction bias and calibration error compensate"
_PUBLISHED = "table_6_compensation"
_HEADS = {
    "correct": "(0, 0)",
    "reconstruction-only": "(+0.1, 0)",
    "predictor-only": "(0, +0.1)",
    "shared": "(+0.1, +0.1)",
}
_MEANS = (
    "Mean over reconstruction seeds of the median over windows; DOB has nothing to train. Windows: "
    "flights with the GRU of seed 0 under correct inputs, obstacles at L3."
)


def build(results: Results) -> Built:
    """Return Table VI, part (a) and part (b)."""
    return _acceleration(results), _negative_offset(results)


def by_seed(
    measure: Callable[[str, str, int], Measurement], method: str, interface: str
) -> tuple[Measurement, ...]:
    """Return one measurement for each seed of a method."""
    return tuple(measure(method, interface, seed) for seed in seeds(method))


def published_negative() -> tuple[PublishedContrast, ...]:
    """Return what the paper prints of GRU+DCC minus GRU, one for each of `NEGATIVE`."""
    paper = published(_PUBLISHED, "b_negative_offset_success")
    return tuple(
        PublishedContrast(wins_losses=counts, p_value=wording.p_value(p))
        for counts, p in zip(paper["dcc_only_gru_only"], paper["mcnemar_exact_p"], strict=True)
    )


def _acceleration(results: Results) -> Table:
    paper = published(_PUBLISHED, "a_analytic_acceleration_error_mps2")
    alone = paper["GRU_wind_term_only"]
    wind_term = {"reconstruction-only": alone["isolated"], "shared": alone["shared"]}
    return Table(
        name="table-6a",
        title="Error of the analytic acceleration (paper, Table VI (a))",
        columns=tuple(f"{head} (m/s²)" for head in _HEADS.values()),
        lines=(
            *(
                Line(
                    label=NAMES[method],
                    entries=tuple(
                        _accelerations(
                            printed(value, 2), results, by_seed(acceleration_error, method, at)
                        )
                        for value, at in zip(paper[NAMES[method]], INTERFACES, strict=True)
                    ),
                )
                for method in METHODS
            ),
            Line(
                label="GRU, wind term alone",
                entries=tuple(
                    _accelerations(
                        printed(wind_term[at], 2), results, by_seed(wind_term_error, "gru", at)
                    )
                    if at in wind_term
                    else BLANK
                    for at in INTERFACES
                ),
            ),
        ),
        notes=(
            "Columns: calibration error of the reconstruction and of the predictor.",
            f"{_MEANS} {recorded(results, PAGE.measurements)}",
            "Wind term alone: error of the part that the wind adds to the acceleration.",
        ),
    )


@guarded
def _accelerations(results: Results, measurements: Iterable[Measurement]) -> Entry:
    return Entry(text=wording.plain(mean_of_medians(results, measurements), 2))


def _negative_offset(results: Results) -> Table:
    paper = published(_PUBLISHED, "b_negative_offset_success")
    columns = [
        contrast_entries(results, negative("gru+dcc", path), negative("gru", path), printed_test)
        for path, printed_test in zip(NEGATIVE, published_negative(), strict=True)
    ]
    _, intervals, counts, tests, least = zip(*columns, strict=True)
    return Table(
        name="table-6b",
        title="Success under the negative offset (paper, Table VI (b))",
        columns=("(0, 0)", "(−0.1, 0)", "(−0.1, −0.1)"),
        lines=(
            *(
                Line(
                    label=f"{NAMES[method]} (%)",
                    entries=tuple(
                        success(printed(value), results, negative(method, path))
                        for value, path in zip(paper[NAMES[method]], NEGATIVE, strict=True)
                    ),
                )
                for method in ("gru", "gru+dcc")
            ),
            Line(label="GRU+DCC minus GRU, 95 % interval (pp)", entries=intervals),
            Line(label="GRU+DCC only:GRU only", entries=counts),
            Line(label="Exact McNemar p", entries=tests),
            Line(label="Least detectable difference (pp)", entries=least),
        ),
        notes=(
            flown(results, CELLS),
            "Columns: calibration error of the reconstruction and of the predictor, both of seed "
            "0; obstacles at L3.",
        ),
    )


PAGE = Page(
    "table-6",
    TITLE,
    CELLS,
    tuple(m for m in MEASUREMENTS if m.quantity != "position-error"),  # those are in the text
    build,
)
