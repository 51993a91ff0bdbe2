"""Why results in wind differ from the paper's: experiments on the selection library.

None of this is in the paper. Each table changes one assumption in which our system may differ.
"""

from faultpath.evidence import Measurement
from faultpath.report import wording
from faultpath.studies.cells import SELECTION, Cell, Setting, calibration
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres, guarded, success
from faultpath.studies.notes import INTERVALS, LEAST, WINS, flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.table_1 import recording
from faultpath.studies.quantities.windows import quantile
from faultpath.studies.results import Results
from faultpath.tables import Entry, Line, Table

TITLE = "Experiments on what differs from the paper, in wind"

WINDY = Setting(library=SELECTION, wind="L3")
STIFF = Setting(library=SELECTION, wind="L3", others=(("planner", "running"),))
"""A planner whose cost counts the distance to the goal all along the horizon."""


def _cell(setting: Setting, variant: str, *faults: str) -> Cell:
    return Cell(setting, variant, faults, quick=False)


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
RECORDED = recording(_cell(WINDY, "gru"))
"""Windows of flights with the reference reconstruction, seed 0."""


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
    *map(dose, DOSES),
    *(_cell(WINDY, variant) for variant in WIND_INPUTS.values()),
    *(stiff(method, path) for method in ("gru", "gru+dcc") for path in PATHS),
)
MEASUREMENTS = (*map(dose_error, DOSES), *map(wind_error, WIND_INPUTS.values()))


def build(results: Results) -> Built:
    """Return one table for each experiment."""
    return _doses(results), _stiff(results), _winds(results)


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


PAGE = Page("differences-wind", TITLE, CELLS, MEASUREMENTS, build)
