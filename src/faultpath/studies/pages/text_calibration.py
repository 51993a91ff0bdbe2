"""In the text on calibration: probes of what predictions depend on, and noisy, delayed states."""

from faultpath.studies.contrasts import UNPUBLISHED, PublishedContrast, contrast_lines
from faultpath.studies.entries import centimetres, printed, success
from faultpath.studies.notes import INTERVALS, WINS, flown, recorded
from faultpath.studies.page import Built, Page
from faultpath.studies.pages.in_text import ERRORS, PROBES, noisy, response
from faultpath.studies.pages.table_2 import NAMES
from faultpath.studies.published import published
from faultpath.studies.results import Results
from faultpath.tables import Line, Table

TITLE = "Probes, and state noise with delay"
REPAIR, BASELINE = "wm-a+dcc", "wm-a"
CELLS = tuple(noisy(model, error) for model in (BASELINE, REPAIR) for error in ERRORS)
MEASUREMENTS = tuple(response(model, probe) for model in (BASELINE, REPAIR) for probe in PROBES)
_LABELS = {
    "calibration": ("Calibration, e = +0.1", "probe_WM-A_calibration_response_cm"),
    "history shuffle": ("History shuffled", "probe_WM-A_history_shuffle_response_cm"),
}


def build(results: Results) -> Built:
    """Return the responses to probes, and success under state noise and delay."""
    return _probes(results), _noise(results)


def _probes(results: Results) -> Table:
    return Table(
        name="text-probes",
        title="Response of the prediction to a probe (paper, Section V)",
        columns=("WM-A (cm)", "WM-A+DCC (cm)"),
        lines=tuple(_probe(results, probe) for probe in PROBES),
        notes=(
            "Median over windows of how far the position predicted 20 control steps ahead moves, "
            "all else fixed; seed 0. Windows: flights with the true-parameter model, obstacles of "
            "the selection library. The shuffle shows dependence; it is no model of noise.",
            recorded(results, MEASUREMENTS),
        ),
    )


def _probe(results: Results, probe: str) -> Line:
    label, key = _LABELS[probe]
    paper = published("in_text", key)
    return Line(
        label=label,
        entries=(
            centimetres(printed(paper["before_dcc"]), results, response(BASELINE, probe)),
            centimetres(printed(paper["after_dcc"]), results, response(REPAIR, probe)),
        ),
    )


def _noise(results: Results) -> Table:
    paper = published("in_text", "state_noise_and_delay_correct_calibration")
    nominal = PublishedContrast(wins_losses=paper["discordant"])
    pairs = [(noisy(REPAIR, error), noisy(BASELINE, error)) for error in ERRORS]
    return Table(
        name="text-noise",
        title="State noise and delay (paper, Section V)",
        columns=("e = −0.1", "e = 0", "e = +0.1"),
        lines=(
            *(_success(results, model, paper[NAMES[model]]) for model in (BASELINE, REPAIR)),
            Line(label="WM-A+DCC minus WM-A (pp)"),
            *contrast_lines(results, pairs, (UNPUBLISHED, nominal, UNPUBLISHED)),
        ),
        notes=(flown(results, CELLS), WINS, INTERVALS),
    )


def _success(results: Results, model: str, paper: int) -> Line:
    entries = (
        success("" if error else printed(paper), results, noisy(model, error)) for error in ERRORS
    )
    return Line(label=f"{NAMES[model]} (%)", entries=tuple(entries))


PAGE = Page("text-calibration", TITLE, CELLS, MEASUREMENTS, build)
