"""In the text on wind: prediction errors in wind, reconstruction controls, and freezing."""

from faultpath.studies.cells import of_seed
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres
from faultpath.studies.notes import EVERY_NOISE, INTERVALS, LEAST, WINDOWS, WINS
from faultpath.studies.page import Page, Row, TableSpec
from faultpath.studies.pages.in_text import (
    CALIBRATION_WITHHELD,
    CODE_FROZEN,
    CODE_UPDATED,
    WIND_FROZEN,
    WIND_UPDATED,
    WINDY_SUBJECTS,
    WITHHELD_FROZEN,
    WITHHELD_UPDATED,
    noisy_wind,
    windy_error,
)
from faultpath.studies.pages.table_3 import GRU, ROWS, TRUE, WITHHELD, ZERO
from faultpath.studies.pages.table_4 import cell, published_methods
from faultpath.studies.published import published

_PAPER = published("in_text")
_RATES = published("table_4_shared_calibration")
_GRU, _DCC = cell("gru", "correct"), cell("gru+dcc", "correct")
_GRU_SEED_0 = published("table_6_compensation", "b_negative_offset_success", "GRU")[0]
_WIND = _PAPER["freeze_reconstructed_wind_at_step_20"]
_CODE = _PAPER["freeze_history_encoding"]

PAGE = Page(
    "text-wind",
    "Wind: prediction errors, reconstruction controls and freezing",
    (
        TableSpec(
            name="text-windy-errors",
            title="Prediction error on common trajectories in wind (paper, Section VI)",
            columns=("Error (cm)",),
            rows=tuple(
                Row(ROWS[variant][0], (centimetres(windy_error(subject)),))
                for variant, subject in zip((TRUE, WITHHELD, ZERO), WINDY_SUBJECTS, strict=True)
            ),
            notes=(
                f"{WINDOWS} Trajectories: true-parameter model with the true wind, obstacles at "
                "L3; seed 0. The paper states the order only.",
                "{recorded}",
            ),
        ),
        TableSpec(
            name="text-reconstructions",
            title="Reconstructions at L3, obstacles (paper, Section VI)",
            columns=COMPARED,
            rows=(
                comparison(
                    "GRU minus zero input, state noise and delay", noisy_wind(GRU), noisy_wind(ZERO)
                ),
                comparison(
                    "GRU without calibration minus GRU, seed 0",
                    of_seed(CALIBRATION_WITHHELD),
                    of_seed(_GRU),
                    (_PAPER["reconstruction_without_calibration_success"], _GRU_SEED_0),
                ),
                comparison(
                    "GRU without calibration minus GRU",
                    CALIBRATION_WITHHELD,
                    _GRU,
                    ("", _RATES["GRU"][0]),
                ),
                comparison(
                    "GRU+DCC minus GRU",
                    _DCC,
                    _GRU,
                    (_RATES["GRU+DCC"][0], _RATES["GRU"][0]),
                    published_methods("gru+dcc", "gru")[0],
                ),
            ),
            notes=("{flown}", EVERY_NOISE, WINS, LEAST, INTERVALS),
        ),
        TableSpec(
            name="text-freezes",
            title="Freezing an input, frozen minus updated (paper, Sections VI and VII)",
            columns=COMPARED,
            rows=(
                comparison(
                    "Trajectory GRU's wind, from step 20",
                    WIND_FROZEN,
                    of_seed(WIND_UPDATED),
                    (_WIND["after"], _WIND["before"]),
                ),
                comparison(
                    "History code of WM-A+DCC, e = +0.1",
                    CODE_FROZEN,
                    of_seed(CODE_UPDATED),
                    _CODE["WM-A+DCC obstacles e=+0.1"],
                ),
                comparison(
                    "History code of the wind-withheld model",
                    WITHHELD_FROZEN,
                    WITHHELD_UPDATED,
                    _CODE["wind-withheld free space L3"],
                ),
            ),
            notes=(
                "{flown}",
                "First: frozen; second: updated; so we read the paper's order of its two figures.",
                "The wind in free space at L3; the code of WM-A+DCC in obstacles without wind; "
                "that of the wind-withheld model in free space at L3 of the selection library.",
                WINS,
                LEAST,
                INTERVALS,
            ),
        ),
    ),
)
