"""Table III: success under wind, by what the predictor was trained with and what it is told.

The paper averages some rows over three seeds at L3; all other entries use the first.
"""

from faultpath_quadrotor.paper.cells import SEEDS, Cell, Setting, published
from faultpath_quadrotor.paper.page import FLOWN_ONCE, Page, Row, Rows, TableSpec, rates

LEVELS = ("L0", "L2", "L3")
ENVIRONMENTS = ("free-space", "obstacles")

WITHHELD, ZERO, TRAJECTORY, GRU, TRUE = (
    "wm-a-nowind",
    "zero-wind",
    "gru-trajectory",
    "gru",
    "true-wind",
)
ZERO_OF_EVERY_SEED = "wm-a-wind/zero-wind"
"""The zero input to the predictor of the arm's seed; `zero-wind` has that of seed 0."""


AVERAGED = {"free-space": (WITHHELD, ZERO, TRAJECTORY), "obstacles": (TRAJECTORY, GRU)}
"""Whose figure at L3 is a mean over three seeds, of the predictor or of the reconstruction."""


def cell(variant: str, environment: str, level: str) -> Cell:
    """Return a row's cell at a wind level; at L0 the true wind is the zero input."""
    variant = ZERO if (variant, level) == (TRUE, "L0") else variant
    setting = Setting(environment=environment, wind=level)
    if level != "L3" or variant not in AVERAGED[environment]:
        return Cell(setting, variant, fixed=variant in (ZERO, TRUE))
    return Cell(setting, ZERO_OF_EVERY_SEED if variant == ZERO else variant, seeds=SEEDS)


ROWS = {
    WITHHELD: ("Wind-withheld, no input", "wind-withheld/none"),
    ZERO: ("Wind-conditioned, zero", "wind-conditioned/zero"),
    TRAJECTORY: ("Wind-conditioned, trajectory GRU", "wind-conditioned/trajectory-GRU"),
    GRU: ("Wind-conditioned, GRU", "wind-conditioned/GRU"),
    TRUE: ("Wind-conditioned, ground truth", "wind-conditioned/ground-truth"),
}
"""Label and published key of every variant."""

TITLE = "Success under wind, with and without obstacles"
_PAPER = published("table_3_wind")
_HEADINGS = {"free-space": "Free space", "obstacles": "Obstacles"}


def paper_rate(variant: str, environment: str, level: str) -> float:
    """Return the success that the paper prints, percent."""
    return _PAPER[environment.replace("-", "_")][ROWS[variant][1]][LEVELS.index(level)]


def _levels(environment: str) -> Rows:
    papers = _PAPER[environment.replace("-", "_")]
    rows = (
        rates(label, (cell(variant, environment, level) for level in LEVELS), papers[key])
        for variant, (label, key) in ROWS.items()
    )
    return Row(_HEADINGS[environment]), *rows


PAGE = Page(
    "table-3",
    TITLE,
    (
        TableSpec(
            name="table-3",
            title=f"{TITLE} (paper, Table III)",
            columns=tuple(f"{level} (%)" for level in LEVELS),
            rows=(*_levels("free-space"), *_levels("obstacles")),
            notes=(
                "{flown}",
                "A figure with a decimal is a mean over seeds; the others are of seed 0. "
                f"{FLOWN_ONCE}",
                "At L0 the true wind is zero; those entries are the zero-input runs.",
            ),
        ),
    ),
)
