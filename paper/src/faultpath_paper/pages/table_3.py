"""Table III: success under wind, by what the predictor was trained with and what it is told.

The paper averages some rows over three seeds at L3; all other entries use the first.
"""

from faultpath.system import Status
from faultpath_paper.cells import SEEDS, Cell, Setting, of_seed, published
from faultpath_paper.entries import EntryGroup, Made
from faultpath_paper.page import Page, Rows, TableRow, table
from faultpath_paper.pages.grid import Grid
from faultpath_paper.results import Results

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
"""The zero input to the predictor of the treatment's seed; `zero-wind` has that of seed 0."""


UNMET = range(70, 100)
"""Held-out scenes whose winds the trajectory GRU has not met: those of 0 to 69 recur from the
selection scenes of its training."""

AVERAGED = {"free-space": (WITHHELD, ZERO, TRAJECTORY), "obstacles": (TRAJECTORY, GRU)}
"""Variants whose figure at L3 is a mean over three seeds of predictor or reconstruction."""


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

_PAPER = published("table_3_wind")
_HEADINGS = {"free-space": "Free space", "obstacles": "Obstacles"}


def _grid(environment: str) -> Grid:
    keys = {variant: key for variant, (_, key) in ROWS.items()}

    def at(variant: str, level: str) -> Cell:
        return cell(variant, environment, level)

    return Grid(at, keys, LEVELS, _PAPER[environment])


GRIDS = {environment: _grid(environment) for environment in ENVIRONMENTS}


def _levels(environment: str) -> Rows:
    rows = (GRIDS[environment].rates(variant, label) for variant, (label, _) in ROWS.items())
    return TableRow(_HEADINGS[environment]), *rows


def _unmet(variant: str, key: str) -> TableRow:
    papers = _PAPER["unseen_wind_subset_L3"][key]
    groups = (
        _won(cell(variant, environment, "L3"), papers[environment]) for environment in ENVIRONMENTS
    )
    return TableRow(ROWS[variant][0], tuple(groups))


def _won(row: Cell, paper: int | list[int]) -> EntryGroup:
    """Return successes among the unmet scenes, seed by seed where the paper has each seed's."""
    by_seed = isinstance(paper, list)
    shown = row if by_seed else of_seed(row)

    def make(results: Results) -> Made:
        trainings = (of_seed(shown, seed) for seed in results.seeds(shown))
        pairs = (results.pairs(cell, cell, scenes=UNMET) for cell in trainings)
        return ("/".join(str(int(pair.ended(Status.SUCCESS)[0].sum())) for pair in pairs),)

    return EntryGroup(make, ("/".join(map(str, paper)) if by_seed else str(paper),), (shown,))


PAGE = Page(
    "table-3",
    (
        table("table-3", *_levels("free-space"), *_levels("obstacles")),
        table(
            "table-3b",
            _unmet(TRAJECTORY, "trajectory-GRU_seeds"),
            _unmet(ZERO, "zero"),
            _unmet(TRUE, "ground-truth"),
            scenes=len(UNMET),
            first=UNMET[0],
            last=UNMET[-1],
        ),
    ),
)
