"""Figure 3: success over the calibration error, in free space on the selection library."""

from faultpath.record import Point, Series, Sweep
from faultpath.studies.cells import SELECTION, Cell, Setting
from faultpath.studies.notes import flown
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.table_2 import NAMES, faults
from faultpath.studies.published import published
from faultpath.studies.results import NotRun, Results

FREE = Setting(library=SELECTION, environment="free-space")
MODELS = ("wm-a", "wm-a+dcc", "wm-u", "wm-u+dcc")
REPAIRED = ("wm-u+dcc", "wm-a+dcc")
"""Models that the paper describes the figure of."""
ERRORS = tuple(round(-0.3 + 0.05 * i, 2) for i in range(13))
QUICK_ERRORS = (-0.3, -0.1, 0.0, 0.1, 0.3)


def cell(variant: str, error: float) -> Cell:
    """Return a model under a calibration error in free space, seed 0."""
    return Cell(FREE, variant, faults(error), quick=error in QUICK_ERRORS)


CELLS = tuple(cell(model, error) for model in MODELS for error in ERRORS)
MEASUREMENTS = ()

TITLE = "Success over the calibration error, free space"
_PUBLISHED = "figure_3_free_space_sweep"


def build(results: Results) -> Built:
    """Return Figure 3."""
    words = (f"{NAMES[model]}: {published(_PUBLISHED, NAMES[model])}" for model in REPAIRED)
    low, high = published(_PUBLISHED, "tested_range")
    sweep = Sweep(
        name="figure-3",
        title=f"{TITLE} (paper, Figure 3)",
        x_title="Calibration error e",
        y_title="Success (%)",
        series=tuple(Series(label=NAMES[m], points=_points(results, m)) for m in MODELS),
        published=f"e from {low} to {high}. {'; '.join(words)}.",
        notes=(
            flown(results, CELLS),
            "Bands: 95 % score intervals (Wilson's), point by point.",
        ),
    )
    return (sweep,)


def _points(results: Results, model: str) -> tuple[Point, ...]:
    points: list[Point] = []
    for error in ERRORS:
        try:
            rate = results.rate(cell(model, error))
        except NotRun:
            continue
        points.append(Point(x=error, y=rate.value, low=rate.low, high=rate.high))
    return tuple(points)


PAGE = Page("figure-3", TITLE, CELLS, MEASUREMENTS, build)
