"""Results that the paper reports in its text only: the claims about them hold their figures."""

from dataclasses import replace

from faultpath_paper.cells import SEEDS, SELECTION, Cell, Setting, calibration, of_seed
from faultpath_paper.evidence.table import Measurement, Quantity, Recording
from faultpath_paper.page import Page
from faultpath_paper.pages import table_1, table_2, table_3, table_4, table_6

NOISE = "noisy_state=1"
"""State noise and delay (paper, Section IV-A: supplementary evaluation)."""
ERRORS = (-0.1, 0.0, 0.1)
FREEZE_CODE = "history_code:freeze,onset=0"
"""Holds the code of the first replan."""
FREEZE_WIND = "wind:freeze,onset=20"


def noisy(variant: str, error: float) -> Cell:
    """Return a model under state noise and delay, and a calibration error."""
    return Cell(table_1.STILL, variant, (*table_2.faults(error), NOISE))


def noisy_wind(variant: str) -> Cell:
    """Return a row of Table III at L3, among obstacles, under state noise and delay."""
    return replace(table_3.cell(variant, "obstacles", "L3"), faults=(NOISE,))


FREE_L3 = Setting(environment="free-space", wind="L3")
SELECTION_FREE_L3 = Setting(library=SELECTION, environment="free-space", wind="L3")

CODE_UPDATED = table_2.cell("wm-a+dcc", 0.1)
CELLS = {
    # Each freeze beside the same cell without it.
    "wind-updated": table_3.cell(table_3.TRAJECTORY, "free-space", "L3"),
    "wind-frozen": Cell(FREE_L3, table_3.TRAJECTORY, (FREEZE_WIND,)),
    "code-updated": CODE_UPDATED,
    "code-frozen": Cell(table_1.STILL, "wm-a+dcc", (*CODE_UPDATED.faults, FREEZE_CODE)),
    "withheld-updated": Cell(SELECTION_FREE_L3, table_3.WITHHELD),
    "withheld-frozen": Cell(SELECTION_FREE_L3, table_3.WITHHELD, (FREEZE_CODE,)),
    "calibration-withheld": Cell(table_4.WINDY, "gru-withheld"),
    # Table III prints it for seed 0; the claim about it is of all seeds.
    "trajectory-still": replace(table_3.cell(table_3.TRAJECTORY, "obstacles", "L0"), seeds=SEEDS),
}
"""Cells that only the text is about; the paper's are of seed 0 unless it says otherwise."""

CEILING = (
    *table_1.PREDICTORS,
    *table_1.WITH_TRUE_CLEARANCE,
    table_2.cell("wm-a+dcc", 0.0),
    table_2.cell("wm-u+dcc", 0.0),
)
"""Eight configurations without wind and with correct calibration, seed 0."""


def _planner(**others: str) -> Cell:
    setting = Setting(library=SELECTION, others=tuple(others.items()))
    return Cell(setting, "wm-a", quick=others.get("candidates") != "2048")


OTHER_PLANNERS = {
    "1024-candidates": _planner(candidates="1024"),
    "2048-candidates": _planner(candidates="2048"),
    "mode-preserving": _planner(sampler="mode-preserving"),
}
PLANNERS = {"reference": _planner(), **OTHER_PLANNERS}

PROBED = Recording(
    library=SELECTION, variant="true-parameter", options=Setting(library=SELECTION).options
)
"""Common obstacle histories of the selection library."""
PROBES: dict[str, tuple[Quantity, tuple[str, ...]]] = {
    "calibration": ("position-response", (calibration(0.1),)),
    "history-shuffle": ("shuffle-response", ()),
    "history-exchange": ("position-response", ("history_code:shuffle",)),
}
"""Quantity and faults of each probe: the steps of every history change places, or windows exchange
their histories."""


def response(subject: str, probe: str) -> Measurement:
    """Return how far a probe moves a model's 20-step prediction, seed 0."""
    quantity, faults = PROBES[probe]
    return Measurement(recording=PROBED, quantity=quantity, subject=subject, faults=faults)


COMMON_WINDY = Recording(
    library="held-out", variant="true-parameter/true-wind", options=table_4.WINDY.options
)
"""Common trajectories in wind."""


def windy_error(subject: str) -> Measurement:
    """Return a wind predictor's 20-step position error on the common windy trajectories."""
    return Measurement(recording=COMMON_WINDY, quantity="position-error", subject=subject)


WINDY_SUBJECTS = ("wm-a-wind/true-wind", table_3.WITHHELD, "wm-a-wind/zero-wind")

NINE = tuple((method, condition) for method in table_4.METHODS for condition in table_4.CONDITIONS)
"""Methods and interfaces of Table IV."""
MEASURED: tuple[Quantity, ...] = ("acceleration-error", "position-error")
MECHANISM = tuple(
    error
    for quantity in MEASURED
    for method, condition in NINE
    for error in table_6.errors(quantity, method, condition)
)
"""Errors of the analytic acceleration and of the full prediction, of each of the nine."""

PAGE = Page(
    "text",
    more_cells=(
        *(noisy(model, error) for model in ("wm-a", "wm-a+dcc") for error in ERRORS),
        *(noisy_wind(variant) for variant in (table_3.GRU, table_3.ZERO)),
        *CELLS.values(),
        *(table_4.cell(method, condition) for method, condition in NINE),
        *map(of_seed, CEILING),
        *PLANNERS.values(),
    ),
    more_measurements=(
        *(response(model, probe) for model in ("wm-a", "wm-a+dcc") for probe in PROBES),
        *map(windy_error, WINDY_SUBJECTS),
        *MECHANISM,
    ),
)
