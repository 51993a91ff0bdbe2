"""Figure 3: success over the calibration error, in free space on the selection library."""

from faultpath_paper.answers import Point, Series, Sweep
from faultpath_paper.cells import SELECTION, Cell, Setting, published
from faultpath_paper.page import FigureSpec, Page, flown
from faultpath_paper.pages.table_2 import NAMES, faults
from faultpath_paper.results import NotRun, Results

FREE = Setting(library=SELECTION, environment="free-space")
ERRORS = tuple(round(-0.3 + 0.05 * i, 2) for i in range(13))
QUICK_ERRORS = (-0.3, -0.1, 0.0, 0.1, 0.3)


def cell(variant: str, error: float) -> Cell:
    """Return a model under a calibration error in free space, seed 0."""
    return Cell(FREE, variant, faults(error), quick=error in QUICK_ERRORS)


_PAPER = published("figure_3_free_space_sweep")


CELLS = tuple(cell(model, error) for model in NAMES for error in ERRORS)


def _build(results: Results) -> Sweep:
    words = (f"{model}: {_PAPER[model]}" for model in ("WM-U+DCC", "WM-A+DCC"))
    low, high = _PAPER["tested_range"]
    return Sweep(
        name="figure-3",
        title="Success over the calibration error, free space (paper, Figure 3)",
        x_title="Calibration error e",
        y_title="Success (%)",
        series=tuple(
            Series(label=name, points=_points(results, model)) for model, name in NAMES.items()
        ),
        published=f"e from {low} to {high}. {'; '.join(words)}.",
        notes=(flown(results, CELLS), "Bands: 95 % score intervals (Wilson's), point by point."),
    )


def _points(results: Results, model: str) -> tuple[Point, ...]:
    points: list[Point] = []
    for error in ERRORS:
        try:
            rate = results.rate(cell(model, error))
        except NotRun:
            continue
        points.append(Point(x=error, y=rate.value, low=rate.low, high=rate.high))
    return tuple(points)


PAGE = Page("figure-3", (FigureSpec(_build, CELLS),))
