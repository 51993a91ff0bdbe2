"""Why results in wind differ from the paper's: experiments on the selection library.

None of this is in the paper. Each table changes one assumption in which our system may differ.
"""

from faultpath.evidence import Measurement
from faultpath.studies.cells import SELECTION, Cell, Setting, calibration
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres, measured, success
from faultpath.studies.notes import INTERVALS, LEAST, WINS
from faultpath.studies.page import Page, Row, TableSpec
from faultpath.studies.pages.table_1 import recording
from faultpath.studies.pages.table_4 import PATHS

WINDY = Setting(library=SELECTION, wind="L3")
STIFF = Setting(library=SELECTION, wind="L3", others=(("planner", "running"),))
"""A planner whose cost counts the distance to the goal all along the horizon."""


def _cell(setting: Setting, variant: str, *faults: str) -> Cell:
    return Cell(setting, variant, faults, quick=False)


RECORDED = recording(_cell(WINDY, "gru"))
"""Windows of flights with the reference reconstruction, seed 0."""


# How much an error of the reconstruction costs, by its size.
def dose(error: float) -> Cell:
    """Return the reference reconstruction with an error of its own calibration alone."""
    return _cell(WINDY, "gru", *((calibration(error, "reconstruction"),) if error else ()))


def _dose(error: float) -> Row:
    compared = comparison(f"e_R = {error:+g}", dose(error), dose(0.0))
    acceleration = Measurement(
        recording=RECORDED,
        quantity="acceleration-error",
        subject="gru",
        faults=dose(error).faults,
    )
    return Row(compared.label, (measured((acceleration,)), *compared.groups))


# The same by the planner.
def _stiff(path: str) -> Row:
    repair, baseline = (_cell(STIFF, method, *PATHS[path]) for method in ("gru+dcc", "gru"))
    return comparison(path.capitalize(), repair, baseline)


# What the wind input holds: the true wind, or what makes the predictor right.
def _wind(label: str, variant: str) -> Row:
    error = Measurement(recording=RECORDED, quantity="position-error", subject=variant)
    return Row(label, (centimetres(error), success(_cell(WINDY, variant))))


PAGE = Page(
    "differences-wind",
    "Experiments on what differs from the paper, in wind",
    (
        TableSpec(
            name="differs-doses",
            title="GRU with a calibration error of the reconstruction alone, minus without, L3",
            columns=("Acceleration error (m/s²)", *COMPARED),
            rows=tuple(map(_dose, (0.0, 0.025, 0.05, 0.1))),
            notes=(
                "Acceleration error: as in Table VI (a), on windows of the selection library.",
                "{recorded}",
                "{flown}",
                WINS,
                LEAST,
                INTERVALS,
            ),
        ),
        TableSpec(
            name="differs-stiff",
            title="GRU+DCC minus GRU with a planner that is stiff in height, L3",
            columns=COMPARED,
            rows=tuple(map(_stiff, PATHS)),
            notes=(
                "The planner named running: its cost counts the distance to the goal all along "
                "the horizon, and not only at its end.",
                "{flown}",
                WINS,
                LEAST,
                INTERVALS,
            ),
        ),
        TableSpec(
            name="differs-winds",
            title="What the wind input holds: error of the prediction and success, L3",
            columns=("20-step position error (cm)", "Success (%)"),
            rows=(
                _wind("Ground-truth wind", "true-wind"),
                _wind("DOB", "dob"),
                _wind("GRU", "gru"),
                _wind("GRU+DCC", "gru+dcc"),
            ),
            notes=(
                "The predictor's wind map has the nominal drag coefficients, which may not be a "
                "vehicle's own. A reconstruction sees the acceleration that is missing, whatever "
                "it comes from.",
                "{recorded}",
                "{flown}",
            ),
        ),
    ),
)
