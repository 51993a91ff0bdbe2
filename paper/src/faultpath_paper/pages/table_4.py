"""Table IV: reconstructions of the wind under an isolated and under a shared calibration error."""

from collections.abc import Iterable, Mapping
from typing import Any

from faultpath.report.sentences import wording
from faultpath_paper.cells import SEEDS, Cell, Setting, calibration, published
from faultpath_paper.entries import EntryGroup, of_quantity
from faultpath_paper.page import Columns, TableRow, page_of
from faultpath_paper.pages.grid import Grid
from faultpath_paper.quantities.differences import Effect, combined, succeeded, terminal_distance
from faultpath_paper.results import Quantity

WINDY = Setting(wind="L3")
NAMES = {"gru": "GRU", "gru+dcc": "GRU+DCC", "dob": "DOB"}
"""Names in print."""
METHODS = tuple(NAMES)
ERROR = 0.1

CONDITIONS: dict[str, tuple[str, ...]] = {
    "correct": (),
    "reconstruction-only": (calibration(ERROR, "reconstruction"),),
    "shared": (calibration(ERROR),),
}
"""Faults by interface: (e_R, e_P) = (0, 0), (+0.1, 0), (+0.1, +0.1)."""


def cell(method: str, condition: str) -> Cell:
    """Return a method on an interface; the observer learns nothing and flies once."""
    if method == "dob":
        return Cell(WINDY, method, CONDITIONS[condition], fixed=True)
    return Cell(WINDY, method, CONDITIONS[condition], seeds=SEEDS)


GRID = Grid(cell, NAMES, tuple(CONDITIONS), published("table_4_shared_calibration"))
FARTHER = GRID.figures["terminal_distance_GRU+DCC_minus_GRU_m"]
"""Terminal goal distance of GRU+DCC minus GRU, as the paper prints it."""


def pair(first: str, second: str, condition: str) -> tuple[Cell, Cell]:
    """Return two methods on an interface."""
    return cell(first, condition), cell(second, condition)


def change(first: str, second: str, effect: Effect) -> Quantity:
    """Return how much more an effect is under the shared error than under the isolated one."""
    shared, alone = (pair(first, second, where) for where in ("shared", "reconstruction-only"))
    return combined((1, shared), (-1, alone), effect=effect)


def last_column(label: str, group: EntryGroup, *below: str) -> Columns:
    """Return a change between the columns with its intervals, in the last of them."""
    blank = EntryGroup(lambda results: ("",) * 3, ("",) * 3)
    return Columns((label, "95 % interval", *below), (*[blank] * (len(CONDITIONS) - 1), group))


def _shown(
    quantity: Quantity, cells: Iterable[Cell], paper: Mapping[str, Any], digits: int
) -> EntryGroup:
    texts = wording.signed(paper["mean"], digits), wording.bracket(paper["ci95"], digits)
    return of_quantity(quantity, cells, texts, digits)


def _changed(
    first: str, second: str, effect: Effect, paper: Mapping[str, Any], digits: int = 1
) -> EntryGroup:
    cells = [
        cell(method, condition) for method in (first, second) for condition in list(CONDITIONS)[1:]
    ]
    return _shown(change(first, second, effect), cells, paper, digits)


def _farther(condition: str) -> EntryGroup:
    cells = pair("gru+dcc", "gru", condition)
    quantity = combined((1, cells), effect=terminal_distance)
    return _shown(quantity, cells, FARTHER[condition], 2)


PAGE = page_of(
    "table-4",
    TableRow("Success (%)"),
    *map(GRID.rates, METHODS),
    *GRID.differences("gru+dcc", "gru", ", success (pp)"),
    *GRID.differences("dob", "gru", ", success (pp)"),
    *GRID.differences("dob", "gru+dcc", ", success (pp)"),
    last_column(
        "DOB minus GRU, shared minus reconstruction-only (pp)",
        _changed("dob", "gru", succeeded, GRID.figures["DOB_GRU_interaction_pp"]),
        "Score interval",
    ),
    TableRow("Terminal distance, secondary, GRU+DCC minus GRU (m)"),
    Columns(("Mean difference", "95 % interval"), tuple(map(_farther, CONDITIONS))),
    last_column(
        "Shared minus reconstruction-only (m)",
        _changed("gru+dcc", "gru", terminal_distance, FARTHER["change"], 2),
    ),
)
