"""In the text on wind: prediction errors in wind, reconstruction controls, and freezing."""

from faultpath.studies.cells import of_seed
from faultpath.studies.contrasts import COMPARED, comparison
from faultpath.studies.entries import centimetres, printed
from faultpath.studies.notes import EVERY_NOISE, INTERVALS, LEAST, WINDOWS, WINS, flown, recorded
from faultpath.studies.page import Built, Page
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
from faultpath.studies.pages.table_3 import GRU, ZERO
from faultpath.studies.pages.table_4 import cell as wind_cell
from faultpath.studies.pages.table_4 import published_methods
from faultpath.studies.published import published
from faultpath.studies.results import Results
from faultpath.tables import Line, Table

TITLE = "Wind: prediction errors, reconstruction controls and freezing"
NOISY = (noisy_wind(GRU), noisy_wind(ZERO))
RECONSTRUCTIONS = (wind_cell("gru", "correct"), wind_cell("gru+dcc", "correct"))
FREEZES = (
    ("Trajectory GRU's wind, from step 20", WIND_FROZEN, of_seed(WIND_UPDATED)),
    ("History code of WM-A+DCC, e = +0.1", CODE_FROZEN, of_seed(CODE_UPDATED)),
    ("History code of the wind-withheld model", WITHHELD_FROZEN, WITHHELD_UPDATED),
)
"""What is frozen, and the cells with and without that, seed 0."""
CELLS = (
    *NOISY,
    *RECONSTRUCTIONS,
    CALIBRATION_WITHHELD,
    *(cell for _, *pair in FREEZES for cell in pair),
)
MEASUREMENTS = tuple(map(windy_error, WINDY_SUBJECTS))
_SUBJECTS = (
    "Wind-conditioned, ground truth",
    "Wind-withheld, no input",
    "Wind-conditioned, zero",
)


def build(results: Results) -> Built:
    """Return the tables of this page."""
    return _errors(results), _reconstructions(results), _freezes(results)


def _errors(results: Results) -> Table:
    return Table(
        name="text-windy-errors",
        title="Prediction error on common trajectories in wind (paper, Section VI)",
        columns=("Error (cm)",),
        lines=tuple(
            Line(label=label, entries=(centimetres("", results, windy_error(subject)),))
            for label, subject in zip(_SUBJECTS, WINDY_SUBJECTS, strict=True)
        ),
        notes=(
            f"{WINDOWS} Trajectories: true-parameter model with the true wind, obstacles at L3; "
            "seed 0. The paper states the order only.",
            recorded(results, MEASUREMENTS),
        ),
    )


def _reconstructions(results: Results) -> Table:
    gru, dcc = RECONSTRUCTIONS
    rates = published("table_4_shared_calibration")
    mean_gru, mean_dcc = printed(rates["GRU"][0]), printed(rates["GRU+DCC"][0])
    withheld = printed(published("in_text", "reconstruction_without_calibration_success"))
    seed_gru = printed(published("table_6_compensation", "b_negative_offset_success", "GRU")[0])
    return Table(
        name="text-reconstructions",
        title="Reconstructions at L3, obstacles (paper, Section VI)",
        columns=COMPARED,
        lines=(
            comparison(results, "GRU minus zero input, state noise and delay", *NOISY),
            comparison(
                results,
                "GRU without calibration minus GRU, seed 0",
                of_seed(CALIBRATION_WITHHELD),
                of_seed(gru),
                (withheld, seed_gru),
            ),
            comparison(
                results,
                "GRU without calibration minus GRU",
                CALIBRATION_WITHHELD,
                gru,
                ("", mean_gru),
            ),
            comparison(
                results,
                "GRU+DCC minus GRU",
                dcc,
                gru,
                (mean_dcc, mean_gru),
                published_methods("gru+dcc", "gru")[0],
            ),
        ),
        notes=(flown(results, (*NOISY, gru, dcc)), EVERY_NOISE, WINS, LEAST, INTERVALS),
    )


def _freezes(results: Results) -> Table:
    wind = published("in_text", "freeze_reconstructed_wind_at_step_20")
    code = published("in_text", "freeze_history_encoding")
    papers = (
        (wind["after"], wind["before"]),
        code["WM-A+DCC obstacles e=+0.1"],
        code["wind-withheld free space L3"],
    )
    lines: list[Line] = []
    for (label, frozen, updated), (first, second) in zip(FREEZES, papers, strict=True):
        rates = (printed(first), printed(second))
        lines.append(comparison(results, label, frozen, updated, rates))
    cells = [cell for _, *pair in FREEZES for cell in pair]
    return Table(
        name="text-freezes",
        title="Freezing an input, frozen minus updated (paper, Sections VI and VII)",
        columns=COMPARED,
        lines=tuple(lines),
        notes=(
            flown(results, cells),
            "First: frozen; second: updated; so we read the paper's order of its two figures.",
            "The wind in free space at L3; the code of WM-A+DCC in obstacles without wind; that of "
            "the wind-withheld model in free space at L3 of the selection library.",
            WINS,
            LEAST,
            INTERVALS,
        ),
    )


PAGE = Page("text-wind", TITLE, CELLS, MEASUREMENTS, build)
