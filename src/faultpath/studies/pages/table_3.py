"""Table III: success under wind, by what the predictor was trained with and what it is told.

The paper averages some rows over three seeds; all others use the first.
"""

from faultpath.studies.cells import SEEDS, Cell, Setting

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

UNSEEN = range(70, 100)
"""Scene indices that the trajectory-trained reconstruction never met the wind of."""


def cell(variant: str, environment: str, level: str) -> Cell:
    """Return a row's cell at a wind level; at L0 the true wind is the zero input."""
    variant = ZERO if (variant, level) == (TRUE, "L0") else variant
    setting = Setting(environment=environment, wind=level)
    if level != "L3":
        return Cell(setting, variant)
    if environment == "free-space" and variant == ZERO:
        return Cell(setting, ZERO_OF_EVERY_SEED, seeds=SEEDS)
    # Among obstacles at L3 rows that are not trained anew meet every seed's planner noise, so
    # that they pair with the reconstructions of every seed.
    seeds = (0,) if environment == "free-space" and variant in (GRU, TRUE) else SEEDS
    return Cell(setting, variant, seeds=seeds)


ROWS = (WITHHELD, ZERO, TRAJECTORY, GRU, TRUE)
CELLS = tuple(
    cell(variant, environment, level)
    for environment in ENVIRONMENTS
    for variant in ROWS
    for level in LEVELS
)
MEASUREMENTS = ()
