"""Table IV: reconstructions of the wind under an isolated and under a shared calibration error."""

from collections.abc import Callable, Sequence

from faultpath.report import wording
from faultpath.statistics import Effect
from faultpath.studies.cells import SEEDS, Cell, Setting, calibration
from faultpath.studies.contrasts import (
    PublishedContrast,
    contrast_lines,
    published_contrasts,
)
from faultpath.studies.entries import BLANK, bracket, of_quantity, printed, success
from faultpath.studies.notes import EVERY_NOISE, INTERVALS, WINS, flown
from faultpath.studies.page import Built, Page
from faultpath.studies.published import published
from faultpath.studies.quantities.differences import combined, success_draws
from faultpath.studies.quantities.found import Quantity
from faultpath.studies.results import Contrast, Results
from faultpath.tables import Entry, Line, Table

WINDY = Setting(wind="L3")
METHODS = ("gru", "gru+dcc", "dob")
ERROR = 0.1

PATHS: dict[str, tuple[str, ...]] = {
    "correct": (),
    "reconstruction-only": (calibration(ERROR, "reconstruction"),),
    "shared": (calibration(ERROR),),
}
"""Faults by interface: (e_R, e_P) = (0, 0), (+0.1, 0), (+0.1, +0.1)."""

CONTRASTS = (("gru+dcc", "gru"), ("dob", "gru"), ("dob", "gru+dcc"))


def cell(method: str, path: str) -> Cell:
    """Return a method on an interface, all seeds.

    The observer is not trained; it meets the planner noise of every seed, to pair with each.
    """
    return Cell(WINDY, method, PATHS[path], seeds=SEEDS)


CELLS = tuple(cell(method, path) for method in METHODS for path in PATHS)
MEASUREMENTS = ()

TITLE = "Wind reconstruction under an isolated and under a shared calibration error"
_PUBLISHED = "table_4_shared_calibration"
NAMES = {"gru": "GRU", "gru+dcc": "GRU+DCC", "dob": "DOB"}
"""Names in print."""


def build(results: Results) -> Built:
    """Return Table IV."""
    paper = published(_PUBLISHED)
    rates = tuple(
        Line(
            label=NAMES[method],
            entries=tuple(
                success(printed(value), results, cell(method, path))
                for value, path in zip(paper[NAMES[method]], PATHS, strict=True)
            ),
        )
        for method in METHODS
    )
    contrasts = [line for pair in CONTRASTS for line in _contrast(results, *pair)]
    table = Table(
        name="table-4",
        title=f"{TITLE} (paper, Table IV)",
        columns=("Correct (0, 0)", "Reconstruction-only (+0.1, 0)", "Shared (+0.1, +0.1)"),
        lines=(
            Line(label="Success (%)"),
            *rates,
            *contrasts,
            *_interaction(results),
            *_terminal_distance(results),
        ),
        notes=(
            flown(results, CELLS),
            "Columns: calibration error of the reconstruction and of the predictor. "
            "Obstacles, wind L3. Predictor of seed 0 throughout; seeds are those of the "
            "reconstruction.",
            EVERY_NOISE,
            WINS,
            INTERVALS,
            "Terminal distance: all paired scenes at the end of the trial; lower is better.",
        ),
    )
    return (table,)


def published_methods(first: str, second: str) -> tuple[PublishedContrast, ...]:
    """Return what the paper prints of one method minus another, one for each of `PATHS`."""
    paper = published(_PUBLISHED, f"{NAMES[first]}_minus_{NAMES[second]}")
    return published_contrasts(paper["pp"], paper["ci95"], paper["wins_losses"])


def _cells(first: str, second: str, path: str) -> tuple[Cell, Cell]:
    return cell(first, path), cell(second, path)


def _contrast(results: Results, first: str, second: str) -> tuple[Line, ...]:
    pairs = [_cells(first, second, path) for path in PATHS]
    return (
        Line(label=f"{NAMES[first]} minus {NAMES[second]}, success (pp)"),
        *contrast_lines(results, pairs, published_methods(first, second)),
    )


def change(first: str, second: str, effect: Callable[[Contrast], Effect]) -> Quantity:
    """Return how much more an effect is under the shared error than under the isolated one."""
    shared, alone = (_cells(first, second, path) for path in ("shared", "reconstruction-only"))
    return combined((1, shared), (-1, alone), effect=effect)


def _interaction(results: Results) -> tuple[Line, ...]:
    """Return how DOB minus GRU changes from reconstruction-only to shared error."""
    paper = published(_PUBLISHED, "DOB_GRU_interaction_pp")
    texts = wording.signed(paper["mean"]), bracket(paper["ci95"])
    found = of_quantity(results, change("dob", "gru", success_draws), texts)
    return _last_column("DOB minus GRU, shared minus reconstruction-only (pp)", found)


def _terminal_distance(results: Results) -> tuple[Line, ...]:
    """Return GRU+DCC minus GRU in terminal goal distance, and its change to the shared error."""
    paper = published(_PUBLISHED, "terminal_distance_GRU+DCC_minus_GRU_m")
    rise, effect = paper["shared_minus_isolated"], Contrast.terminal_distance

    def shown(quantity: Quantity, mean: float, ends: Sequence[float]) -> tuple[Entry, Entry]:
        return of_quantity(results, quantity, (wording.signed(mean, 2), bracket(ends, 2)), 2)

    columns = [
        shown(combined((1, _cells("gru+dcc", "gru", path)), effect=effect), mean, ends)
        for path, mean, ends in zip(PATHS, paper["mean"], paper["ci95"], strict=True)
    ]
    values, intervals = zip(*columns, strict=True)
    found = shown(change("gru+dcc", "gru", effect), rise["mean"], rise["ci95"])
    return (
        Line(label="Terminal distance, secondary, GRU+DCC minus GRU (m)"),
        Line(label="Mean difference", entries=values),
        Line(label="95 % interval", entries=intervals),
        *_last_column("Shared minus reconstruction-only (m)", found),
    )


def _last_column(label: str, entries: Sequence[Entry]) -> tuple[Line, ...]:
    """Return a change between two columns, in the last of them."""
    value, ends = ((BLANK,) * (len(PATHS) - 1) + (entry,) for entry in entries)
    return Line(label=label, entries=value), Line(label="95 % interval", entries=ends)


PAGE = Page("table-4", TITLE, CELLS, MEASUREMENTS, build)
