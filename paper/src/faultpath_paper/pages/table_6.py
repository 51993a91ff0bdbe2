"""Table VI: how reconstruction bias and calibration error compensate, and the negative offset."""

from faultpath.report.sentences import wording
from faultpath_paper.cells import SEEDS, Cell, calibration, published
from faultpath_paper.entries import BLANK, EntryGroup, PublishedContrast, difference, measured
from faultpath_paper.evidence.table import Measurement, Quantity
from faultpath_paper.page import Columns, Page, TableRow, rates, table
from faultpath_paper.pages.table_1 import recording
from faultpath_paper.pages.table_4 import CONDITIONS, ERROR, METHODS, NAMES, WINDY

INTERFACES: dict[str, tuple[str, ...]] = {
    "correct": CONDITIONS["correct"],
    "reconstruction-only": CONDITIONS["reconstruction-only"],
    "predictor-only": (calibration(ERROR, "predictor"),),
    "shared": CONDITIONS["shared"],
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


def errors(quantity: Quantity, method: str, interface: str) -> tuple[Measurement, ...]:
    """Return an error of a method on an interface, for each of its seeds.

    The observer learns nothing: it has one.
    """
    return tuple(
        Measurement(
            recording=WINDOWS,
            quantity=quantity,
            subject=method,
            seed=seed,
            faults=INTERFACES[interface],
        )
        for seed in ((0,) if method == "dob" else SEEDS)
    )


def negative(method: str, condition: str) -> Cell:
    """Return a method under the negative offset, seed 0."""
    return Cell(WINDY, method, NEGATIVE[condition])


_ERRORS, _OFFSET = published("table_6_compensation").values()
_WIND_TERM = _ERRORS["GRU_wind_term_only"]


def paper_acceleration(method: str, interface: str) -> float:
    """Return the analytic acceleration error that the paper prints, m/s²."""
    return _ERRORS[NAMES[method]][list(INTERFACES).index(interface)]


def paper_negative(method: str, condition: str) -> float:
    """Return the success under the negative offset that the paper prints, percent."""
    return _OFFSET[NAMES[method]][list(NEGATIVE).index(condition)]


def _accelerations(method: str) -> TableRow:
    groups = (
        measured(errors("acceleration-error", method, interface), paper)
        for interface, paper in zip(INTERFACES, _ERRORS[NAMES[method]], strict=True)
    )
    return TableRow(NAMES[method], tuple(groups))


def _wind_term(interface: str, key: str) -> EntryGroup:
    return measured(errors("wind-term-error", "gru", interface), _WIND_TERM[key])


def _negative_rates(method: str) -> TableRow:
    cells = (negative(method, condition) for condition in NEGATIVE)
    return rates(f"{NAMES[method]} (%)", cells, _OFFSET[NAMES[method]])


def _negative_difference(condition: str) -> EntryGroup:
    at = list(NEGATIVE).index(condition)
    p_value = wording.p_value(_OFFSET["mcnemar_exact_p"][at])
    paper = PublishedContrast(wins_losses=_OFFSET["dcc_only_gru_only"][at], p_value=p_value)
    return difference(negative("gru+dcc", condition), negative("gru", condition), paper)


PAGE = Page(
    "table-6",
    (
        table(
            "table-6a",
            *map(_accelerations, METHODS),
            TableRow(
                "GRU, wind term alone",
                (
                    BLANK,
                    _wind_term("reconstruction-only", "isolated"),
                    BLANK,
                    _wind_term("shared", "shared"),
                ),
            ),
        ),
        table(
            "table-6b",
            _negative_rates("gru"),
            _negative_rates("gru+dcc"),
            Columns(
                (
                    "",
                    "GRU+DCC minus GRU, 95 % interval (pp)",
                    "Score interval (pp)",
                    "GRU+DCC only:GRU only",
                    "Exact McNemar p",
                    "Least detectable difference (pp)",
                ),
                tuple(map(_negative_difference, NEGATIVE)),
            ),
        ),
    ),
)
