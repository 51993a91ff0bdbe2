"""In the text on calibration: probes of what predictions depend on, and noisy, delayed states."""

from faultpath.studies.contrasts import UNPUBLISHED, PublishedContrast, differences
from faultpath.studies.entries import centimetres
from faultpath.studies.notes import INTERVALS, WINS
from faultpath.studies.page import Page, Row, TableSpec, rates
from faultpath.studies.pages.in_text import ERRORS, noisy, response
from faultpath.studies.published import published

REPAIR, BASELINE = "wm-a+dcc", "wm-a"
_NOISE = published("in_text", "state_noise_and_delay_correct_calibration")


def _probe(label: str, probe: str, key: str) -> Row:
    paper = published("in_text", key)
    return Row(
        label,
        (
            centimetres(response(BASELINE, probe), paper["before_dcc"]),
            centimetres(response(REPAIR, probe), paper["after_dcc"]),
        ),
    )


def _rates(label: str, model: str, nominal: int) -> Row:
    return rates(label, (noisy(model, error) for error in ERRORS), ("", nominal, ""))


PAGE = Page(
    "text-calibration",
    "Probes, and state noise with delay",
    (
        TableSpec(
            name="text-probes",
            title="Response of the prediction to a probe (paper, Section V)",
            columns=("WM-A (cm)", "WM-A+DCC (cm)"),
            rows=(
                _probe(
                    "Calibration, e = +0.1", "calibration", "probe_WM-A_calibration_response_cm"
                ),
                _probe(
                    "History shuffled", "history shuffle", "probe_WM-A_history_shuffle_response_cm"
                ),
            ),
            notes=(
                "Median over windows of how far the position predicted 20 control steps ahead "
                "moves, all else fixed; seed 0. Windows: flights with the true-parameter model, "
                "obstacles of the selection library. The shuffle shows dependence; it is no model "
                "of noise.",
                "{recorded}",
            ),
        ),
        TableSpec(
            name="text-noise",
            title="State noise and delay (paper, Section V)",
            columns=("e = −0.1", "e = 0", "e = +0.1"),
            rows=(
                _rates("WM-A (%)", BASELINE, _NOISE["WM-A"]),
                _rates("WM-A+DCC (%)", REPAIR, _NOISE["WM-A+DCC"]),
                Row("WM-A+DCC minus WM-A (pp)"),
                differences(
                    ((noisy(REPAIR, error), noisy(BASELINE, error)) for error in ERRORS),
                    (UNPUBLISHED, PublishedContrast(wins_losses=_NOISE["discordant"]), UNPUBLISHED),
                ),
            ),
            notes=("{flown}", WINS, INTERVALS),
        ),
    ),
)
