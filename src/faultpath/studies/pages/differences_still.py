"""Why results without wind differ from the paper's: experiments on the selection library.

None of this is in the paper. Each table changes one assumption in which our system may differ.
"""

from faultpath.evidence import Measurement
from faultpath.studies.cells import SELECTION, Cell, Setting, calibration
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres, ended, success
from faultpath.studies.notes import INTERVALS, LEAST, WINS
from faultpath.studies.page import Page, Row, Rows, TableSpec
from faultpath.studies.pages import figure_3
from faultpath.studies.pages.in_text import PROBED
from faultpath.studies.pages.table_2 import NAMES
from faultpath.trials import Status

STILL = Setting(library=SELECTION)
SEEN_THROUGH = Setting(library=SELECTION, others=(("clearance", "true"),))


def _cell(setting: Setting, variant: str, *faults: str) -> Cell:
    return Cell(setting, variant, faults, quick=False)


# The history code: what it holds when it is frozen.
MIS_CALIBRATED = calibration(0.1)
UPDATED = _cell(STILL, "wm-a+dcc", MIS_CALIBRATED)


def _frozen(when: str, onset: int) -> Row:
    frozen = _cell(STILL, "wm-a+dcc", MIS_CALIBRATED, f"history_code:freeze,onset={onset}")
    return comparison(f"Frozen at the {when}", frozen, UPDATED)


# Dependence on calibration, by sign of its error.
SIGNS = (-0.1, 0.1)


def response(model: str, error: float) -> Measurement:
    """Return how far a calibration error moves a model's 20-step prediction, seed 0."""
    return Measurement(
        recording=PROBED,
        quantity="position-response",
        subject=model,
        faults=(calibration(error),),
    )


def _signs(model: str) -> Row:
    return Row(
        NAMES[model],
        (
            *(centimetres(response(model, error)) for error in SIGNS),
            *(success(figure_3.cell(model, error)) for error in SIGNS),
        ),
    )


# Predictors with and without the depth model between them and the obstacles.
PREDICTORS = {"DKI": "dki", "WM-A": "wm-a", "True-parameter": "true-parameter"}


def _view(name: str, setting: Setting) -> Rows:
    ends = (Status.SUCCESS, Status.CRASH, Status.TIMEOUT)
    rows = (
        Row(label, tuple(ended(_cell(setting, predictor), end) for end in ends))
        for label, predictor in PREDICTORS.items()
    )
    return Row(f"With the {name}"), *rows


PAGE = Page(
    "differences-still",
    "Experiments on what differs from the paper, without wind",
    (
        TableSpec(
            name="differs-freezing",
            title="WM-A+DCC at e = +0.1 with the history code frozen, minus updated",
            columns=COMPARED,
            rows=(_frozen("first replan", 0), _frozen("step 12: first whole history", 12)),
            notes=(
                "Our flights start with an empty history: at the first replan nothing has been "
                "commanded yet, so the code cannot know what thrust hovers.",
                "{flown}",
                WINS,
                LEAST,
                INTERVALS,
            ),
        ),
        TableSpec(
            name="differs-signs",
            title="Dependence on calibration by sign of the error",
            columns=(
                "Response, e = −0.1 (cm)",
                "e = +0.1 (cm)",
                "Success, e = −0.1 (%)",
                "e = +0.1 (%)",
            ),
            rows=tuple(map(_signs, NAMES)),
            notes=(
                "Response: median over windows of how far the position predicted 20 control steps "
                "ahead moves. Success in free space without wind. Seed 0.",
                "{recorded}",
            ),
        ),
        TableSpec(
            name="differs-views",
            title="Predictors on the selection library, by source of clearance",
            columns=("Success (%)", "Crash (%)", "Timeout (%)"),
            rows=(*_view("depth model", STILL), *_view("ground-truth clearance", SEEN_THROUGH)),
            notes=("{flown}",),
        ),
    ),
)
