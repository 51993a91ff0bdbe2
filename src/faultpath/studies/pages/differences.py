"""Why some results differ from the paper's: experiments on the selection library.

None of this is in the paper. Each table changes one assumption in which our system may differ.
"""

from faultpath.evidence import Measurement
from faultpath.record import Entry, Line, Table
from faultpath.report import wording
from faultpath.studies.cells import SELECTION, Cell, Setting, calibration
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres, ended, guarded, quantile, success
from faultpath.studies.notes import INTERVALS, LEAST, WINS, flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages import figure_3, table_1
from faultpath.studies.pages.in_text import PROBED
from faultpath.studies.pages.table_2 import NAMES
from faultpath.studies.results import Results
from faultpath.trials import Status

TITLE = "Experiments on what differs from the paper"

STILL = Setting(library=SELECTION)
SEEN_THROUGH = Setting(library=SELECTION, others=(("clearance", "true"),))
WINDY = Setting(library=SELECTION, wind="L3")
STIFF = Setting(library=SELECTION, wind="L3", others=(("planner", "running"),))
"""A planner whose cost counts the distance to the goal all along the horizon."""


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

# How much an error of the reconstruction costs, by its size and by the planner.
DOSES = (0.0, 0.025, 0.05, 0.1)
PATHS: dict[str, tuple[str, ...]] = {
    "correct": (),
    "reconstruction-only": (calibration(0.1, "reconstruction"),),
    "shared": (calibration(0.1),),
}


# What the wind input holds: the true wind, or what makes the predictor right.
WIND_INPUTS = {
    "Ground-truth wind": "true-wind",
    "DOB": "dob",
    "GRU": "gru",
    "GRU+DCC": "gru+dcc",
}
RECORDED = table_1.recording(_cell(WINDY, "gru"))
"""Windows of flights with the reference reconstruction, seed 0."""


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


def dose(error: float) -> Cell:
    """Return the reference reconstruction with an error of its own calibration alone."""
    return _cell(WINDY, "gru", *((calibration(error, "reconstruction"),) if error else ()))


def dose_error(error: float) -> Measurement:
    """Return the analytic acceleration error that goes with a dose."""
    return Measurement(
        recording=RECORDED,
        quantity="acceleration-error",
        subject="gru",
        faults=dose(error).faults,
    )


def wind_error(variant: str) -> Measurement:
    """Return the predictor's 20-step position error with a wind input."""
    return Measurement(recording=RECORDED, quantity="position-error", subject=variant)


def stiff(method: str, path: str) -> Cell:
    """Return a reconstruction on an interface, with the stiff planner."""
    return _cell(STIFF, method, *PATHS[path])


CELLS = (
    UPDATED,
    *FROZEN.values(),
    *(figure_3.cell(model, error) for model in MODELS for error in SIGNS),
    *(viewed(view, name) for view in VIEWS for name in PREDICTORS.values()),
    *map(dose, DOSES),
    *(_cell(WINDY, variant) for variant in WIND_INPUTS.values()),
    *(stiff(method, path) for method in ("gru", "gru+dcc") for path in PATHS),
)
MEASUREMENTS = (
    *(response(model, error) for model in MODELS for error in SIGNS),
    *map(dose_error, DOSES),
    *map(wind_error, WIND_INPUTS.values()),
)


def build(results: Results) -> Built:
    """Return one table for each experiment."""
    return (
        _freezing(results),
        _signs(results),
        _views(results),
        _doses(results),
        _stiff(results),
        _winds(results),
    )


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
            recorded(results, (response(m, e) for m in MODELS for e in SIGNS)),
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


def _doses(results: Results) -> Table:
    def row(error: float) -> Line:
        compared = comparison(results, f"e_R = {error:+g}", dose(error), dose(0.0))
        acceleration = _metres_per_second_squared("", results, dose_error(error))
        return Line(label=compared.label, entries=(acceleration, *compared.entries))

    return Table(
        name="differs-doses",
        title="GRU with a calibration error of the reconstruction alone, minus without, L3",
        columns=("Acceleration error (m/s²)", *COMPARED),
        lines=tuple(map(row, DOSES)),
        notes=(
            "Acceleration error: as in Table VI (a), on windows of the selection library.",
            recorded(results, map(dose_error, DOSES)),
            flown(results, map(dose, DOSES)),
            WINS,
            LEAST,
            INTERVALS,
        ),
    )


@guarded
def _metres_per_second_squared(results: Results, measurement: Measurement) -> Entry:
    return Entry(text=wording.plain(quantile(results, measurement), 2))


def _stiff(results: Results) -> Table:
    return Table(
        name="differs-stiff",
        title="GRU+DCC minus GRU with a planner that is stiff in height, L3",
        columns=COMPARED,
        lines=tuple(
            comparison(results, path.capitalize(), stiff("gru+dcc", path), stiff("gru", path))
            for path in PATHS
        ),
        notes=(
            "The planner variant `running`: its cost counts the distance to the goal all along "
            "the horizon, and not only at its end.",
            flown(results, (stiff(m, p) for m in ("gru", "gru+dcc") for p in PATHS)),
            WINS,
            LEAST,
            INTERVALS,
        ),
    )


def _winds(results: Results) -> Table:
    return Table(
        name="differs-winds",
        title="What the wind input holds: error of the prediction and success, L3",
        columns=("20-step position error (cm)", "Success (%)"),
        lines=tuple(
            Line(
                label=label,
                entries=(
                    centimetres("", results, wind_error(variant)),
                    success("", results, _cell(WINDY, variant)),
                ),
            )
            for label, variant in WIND_INPUTS.items()
        ),
        notes=(
            "The predictor's wind map has the nominal drag coefficients; the vehicles of the "
            "scenes have their own. A reconstruction sees the acceleration that is missing, "
            "whatever it comes from.",
            recorded(results, map(wind_error, WIND_INPUTS.values())),
            flown(results, (_cell(WINDY, variant) for variant in WIND_INPUTS.values())),
        ),
    )


PAGE = Page("differences", TITLE, CELLS, MEASUREMENTS, build)
