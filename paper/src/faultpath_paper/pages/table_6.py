"""Table VI: how reconstruction bias and calibration error compensate, and the negative offset."""

from faultpath.report.sentences import wording
from faultpath_paper.cells import SEEDS, Cell, calibration, published
from faultpath_paper.entries import BLANK, EntryGroup, PublishedContrast, difference, measured
from faultpath_paper.evidence.table import Measurement, Quantity
from faultpath_paper.page import Columns, Page, TableRow, table
from faultpath_paper.pages.grid import Grid
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


_PRINTED, _OFFSET = published("table_6_compensation").values()
_NAMES = {"gru": "GRU", "gru+dcc": "GRU+DCC"}
GRID = Grid(negative, _NAMES, tuple(NEGATIVE), _OFFSET)
PRINTED: dict[tuple[str, ...], float] = {
    **{
        ("acceleration-error", method, interface): figure
        for method in METHODS
        for interface, figure in zip(INTERFACES, _PRINTED[NAMES[method]], strict=True)
    },
    **{
        ("wind-term-error", "gru", interface): figure
        for interface, figure in _PRINTED["GRU_wind_term_only"].items()
    },
}
"""Errors that the paper prints, m/s²."""


def _row(label: str, quantity: Quantity, method: str) -> TableRow:
    groups = (
        measured(errors(quantity, method, interface), PRINTED[quantity, method, interface])
        if (quantity, method, interface) in PRINTED
        else BLANK
        for interface in INTERFACES
    )
    return TableRow(label, tuple(groups))


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
            *(_row(name, "acceleration-error", method) for method, name in NAMES.items()),
            _row("GRU, wind term alone", "wind-term-error", "gru"),
        ),
        table(
            "table-6b",
            *(GRID.rates(method, f"{name} (%)") for method, name in GRID.names.items()),
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
