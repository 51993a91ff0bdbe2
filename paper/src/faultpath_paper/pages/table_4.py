"""Table IV: reconstructions of the wind under an isolated and under a shared calibration error."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from faultpath.report.sentences import wording
from faultpath_paper.cells import SEEDS, Cell, Printed, Setting, calibration, published
from faultpath_paper.entries import EntryGroup, of_quantity, published_contrasts
from faultpath_paper.page import Columns, Page, Rows, TableRow, differences, rates, table
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


def change(first: str, second: str, effect: Effect) -> Quantity:
    """Return how much more an effect is under the shared error than under the isolated one."""
    shared, alone = (
        _cells(first, second, condition) for condition in ("shared", "reconstruction-only")
    )
    return combined((1, shared), (-1, alone), effect=effect)


_PAPER = published("table_4_shared_calibration")


def paper_rate(method: str, condition: str) -> float:
    """Return the success that the paper prints, percent."""
    return _PAPER[NAMES[method]][list(CONDITIONS).index(condition)]


def paper_contrast(first: str, second: str, condition: str) -> Printed:
    """Return what the paper prints of one method minus another, pp."""
    paper, at = _PAPER[f"{NAMES[first]}_minus_{NAMES[second]}"], list(CONDITIONS).index(condition)
    low, high = paper["ci95"][at]
    return Printed(paper["pp"][at], (low, high))


def _cells(first: str, second: str, condition: str) -> tuple[Cell, Cell]:
    return cell(first, condition), cell(second, condition)


def _contrast(first: str, second: str) -> Rows:
    paper = _PAPER[f"{NAMES[first]}_minus_{NAMES[second]}"]
    printed = published_contrasts(paper["pp"], paper["ci95"], paper["wins_losses"])
    return (
        TableRow(f"{NAMES[first]} minus {NAMES[second]}, success (pp)"),
        differences((_cells(first, second, condition) for condition in CONDITIONS), printed),
    )


def last_column(label: str, group: EntryGroup, *below: str) -> Columns:
    """Return a change between the columns with its intervals, in the last of them."""
    blank = EntryGroup(lambda results: ("",) * 3, ("",) * 3)
    return Columns((label, "95 % interval", *below), (*[blank] * (len(CONDITIONS) - 1), group))


def _shown(
    quantity: Quantity, cells: Iterable[Cell], mean: float, ends: Sequence[float], digits: int
) -> EntryGroup:
    texts = wording.signed(mean, digits), wording.bracket(ends, digits)
    return of_quantity(quantity, cells, texts, digits)


def _changed(
    first: str, second: str, effect: Effect, paper: Mapping[str, Any], digits: int = 1
) -> EntryGroup:
    cells = [
        cell(method, condition) for method in (first, second) for condition in list(CONDITIONS)[1:]
    ]
    return _shown(change(first, second, effect), cells, paper["mean"], paper["ci95"], digits)


_FARTHER = _PAPER["terminal_distance_GRU+DCC_minus_GRU_m"]
"""Terminal goal distance of GRU+DCC minus GRU, as the paper prints it."""

PAGE = Page(
    "table-4",
    (
        table(
            "table-4",
            TableRow("Success (%)"),
            *(
                rates(name, (cell(method, condition) for condition in CONDITIONS), _PAPER[name])
                for method, name in NAMES.items()
            ),
            *_contrast("gru+dcc", "gru"),
            *_contrast("dob", "gru"),
            *_contrast("dob", "gru+dcc"),
            last_column(
                "DOB minus GRU, shared minus reconstruction-only (pp)",
                _changed("dob", "gru", succeeded, _PAPER["DOB_GRU_interaction_pp"]),
                "Score interval",
            ),
            TableRow("Terminal distance, secondary, GRU+DCC minus GRU (m)"),
            Columns(
                ("Mean difference", "95 % interval"),
                tuple(
                    _shown(combined((1, pair), effect=terminal_distance), pair, mean, ends, 2)
                    for condition, mean, ends in zip(
                        CONDITIONS, _FARTHER["mean"], _FARTHER["ci95"], strict=True
                    )
                    for pair in [_cells("gru+dcc", "gru", condition)]
                ),
            ),
            last_column(
                "Shared minus reconstruction-only (m)",
                _changed("gru+dcc", "gru", terminal_distance, _FARTHER["shared_minus_isolated"], 2),
            ),
        ),
    ),
)
