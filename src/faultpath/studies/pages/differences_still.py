"""Why results without wind differ from the paper's: experiments on the selection library.

None of this is in the paper. Each table changes one assumption in which our system may differ.
"""

from faultpath.evidence import Measurement
from faultpath.studies.cells import SELECTION, Cell, Setting, calibration
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres, ended, success
from faultpath.studies.notes import INTERVALS, LEAST, WINS, flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages import figure_3
from faultpath.studies.pages.in_text import PROBED
from faultpath.studies.pages.table_2 import NAMES
from faultpath.studies.results import Results
from faultpath.tables import Line, Table
from faultpath.trials import Status

TITLE = "Experiments on what differs from the paper, without wind"

STILL = Setting(library=SELECTION)
SEEN_THROUGH = Setting(library=SELECTION, others=(("clearance", "true"),))


def _cell(setting: Setting, variant: str, *faults: str) -> Cell:
    return Cell(setting, variant, faults, quick=False)


# The history code: what it holds when it is frozen.
MIS_CALIBRATED = calibration(0.1)
UPDATED = _cell(STILL, "wm-a+dcc", MIS_CALIBRATED)
FROZEN = {
    "first replan": _cell(STILL, "wm-a+dcc", MIS_CALIBRATED, "history_code:freeze,onset=0"),
    "step 12: first whole history": _cell(
        STILL, "wm-a+dcc", MIS_CALIBRATED, "history_code:freeze,onset=12"
    ),
}

# Dependence on calibration, by sign of its error.
MODELS = ("wm-a", "wm-a+dcc", "wm-u", "wm-u+dcc")
SIGNS = (-0.1, 0.1)

# Predictors with and without the depth model between them and the obstacles.
PREDICTORS = {"DKI": "dki", "WM-A": "wm-a", "True-parameter": "true-parameter"}
VIEWS = {"depth model": STILL, "ground-truth clearance": SEEN_THROUGH}


def response(model: str, error: float) -> Measurement:
    """Return how far a calibration error moves a model's 20-step prediction, seed 0."""
    return Measurement(
        recording=PROBED,
        quantity="position-response",
        subject=model,
        faults=(calibration(error),),
    )


def viewed(view: str, predictor: str) -> Cell:
    """Return a predictor with one source of clearance."""
    return _cell(VIEWS[view], predictor)


CELLS = (
    UPDATED,
    *FROZEN.values(),
    *(figure_3.cell(model, error) for model in MODELS for error in SIGNS),
    *(viewed(view, name) for view in VIEWS for name in PREDICTORS.values()),
)
MEASUREMENTS = tuple(response(model, error) for model in MODELS for error in SIGNS)


def build(results: Results) -> Built:
    """Return one table for each experiment."""
    return _freezing(results), _signs(results), _views(results)


def _freezing(results: Results) -> Table:
    return Table(
        name="differs-freezing",
        title="WM-A+DCC at e = +0.1 with the history code frozen, minus updated",
        columns=COMPARED,
        lines=tuple(
            comparison(results, f"Frozen at the {when}", cell, UPDATED)
            for when, cell in FROZEN.items()
        ),
        notes=(
            "Our flights start with an empty history: at the first replan nothing has been "
            "commanded yet, so the code cannot know what thrust hovers.",
            flown(results, (UPDATED, *FROZEN.values())),
            WINS,
            LEAST,
            INTERVALS,
        ),
    )


def _signs(results: Results) -> Table:
    return Table(
        name="differs-signs",
        title="Dependence on calibration by sign of the error",
        columns=(
            "Response, e = −0.1 (cm)",
            "e = +0.1 (cm)",
            "Success, e = −0.1 (%)",
            "e = +0.1 (%)",
        ),
        lines=tuple(
            Line(
                label=NAMES[model],
                entries=(
                    *(centimetres("", results, response(model, error)) for error in SIGNS),
                    *(success("", results, figure_3.cell(model, error)) for error in SIGNS),
                ),
            )
            for model in MODELS
        ),
        notes=(
            "Response: median over windows of how far the position predicted 20 control steps "
            "ahead moves. Success in free space without wind. Seed 0.",
            recorded(results, MEASUREMENTS),
        ),
    )


def _views(results: Results) -> Table:
    statuses = (Status.SUCCESS, Status.CRASH, Status.TIMEOUT)
    rows: list[Line] = []
    for view in VIEWS:
        rows.append(Line(label=f"With the {view}"))
        rows += [
            Line(
                label=label,
                entries=tuple(ended("", results, viewed(view, name), end) for end in statuses),
            )
            for label, name in PREDICTORS.items()
        ]
    return Table(
        name="differs-views",
        title="Predictors on the selection library, by source of clearance",
        columns=("Success (%)", "Crash (%)", "Timeout (%)"),
        lines=tuple(rows),
        notes=(flown(results, (viewed(v, p) for v in VIEWS for p in PREDICTORS.values())),),
    )


PAGE = Page("differences-still", TITLE, CELLS, MEASUREMENTS, build)
