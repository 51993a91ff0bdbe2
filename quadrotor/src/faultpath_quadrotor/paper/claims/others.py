"""C36 to C39: withheld calibration, frozen histories, planning and perception (paper, text)."""

from itertools import permutations

from faultpath_quadrotor.paper.cells import Printed, published
from faultpath_quadrotor.paper.claims.rules import BELOW, NO_GAIN, NO_LOSS, at_least, less_than
from faultpath_quadrotor.paper.claims.statement import Statement, Statements
from faultpath_quadrotor.paper.pages import in_text, table_4, table_6
from faultpath_quadrotor.paper.quantities.differences import Pair, combined, success
from faultpath_quadrotor.paper.quantities.summaries import in_all, in_none, share

SAME_ORDER = 3
"""Two costs are of the same order when neither is so many times the other: about root ten."""
GRU = table_4.cell("gru", "correct")
WITHHELD = in_text.CALIBRATION_WITHHELD

_PAPER = published("in_text")
# The paper withholds calibration from seed 0 alone, so its two costs here are those of seed 0.
_NOMINAL = table_6.paper_negative("gru", "correct")
_BY_WITHHOLDING = _PAPER["reconstruction_without_calibration_success"] - _NOMINAL
_BY_DCC = table_6.paper_negative("gru+dcc", "correct") - _NOMINAL
_CHANGES: tuple[tuple[str, Pair, float], ...] = (
    ("withholding", (WITHHELD, GRU), _BY_WITHHOLDING),
    ("GRU+DCC", (table_4.cell("gru+dcc", "correct"), GRU), _BY_DCC),
)


def _frozen(key: str) -> Printed:
    frozen, updated = _PAPER["freeze_history_encoding"][key]
    return Printed(frozen - updated)


CLAIMS: dict[str, Statements] = {
    "C36": (
        Statement(
            "success of the GRU without calibration minus GRU, correct inputs,",
            success(WITHHELD, GRU),
            BELOW,
            Printed(_BY_WITHHOLDING),
        ),
        *(
            Statement(
                f"{SAME_ORDER} times the nominal change by {small}, minus that by {large},",
                combined((SAME_ORDER, change), (-1, other)),
                less_than(0),
                Printed(SAME_ORDER * theirs - theirs_of_other),
            )
            for (small, change, theirs), (large, other, theirs_of_other) in permutations(_CHANGES)
        ),
    ),
    "C37": (
        Statement(
            "success of WM-A+DCC with the history code frozen minus updated, e = +0.1,",
            success(in_text.CODE_FROZEN, in_text.CODE_UPDATED),
            NO_LOSS,
            _frozen("WM-A+DCC obstacles e=+0.1"),
        ),
        Statement(
            "success of the wind-withheld model with the code frozen minus updated, L3,",
            success(in_text.WITHHELD_FROZEN, in_text.WITHHELD_UPDATED),
            NO_LOSS,
            _frozen("wind-withheld free space L3"),
        ),
    ),
    "C38": (
        Statement(
            "percentage of scenes that succeed in all eight configurations",
            share(in_text.CEILING, in_all),
            at_least(50),
            Printed(_PAPER["ceiling_eight_configurations"]["succeed_in_all"]),
        ),
        Statement(
            "percentage of scenes that fail in all eight configurations",
            share(in_text.CEILING, in_none),
            at_least(10),
            Printed(_PAPER["ceiling_eight_configurations"]["fail_in_all"]),
        ),
    ),
    "C39": tuple(
        Statement(
            f"success with {name} minus the reference planner",
            success(planner, in_text.REFERENCE_PLANNER, other_noise=True),
            NO_GAIN,
        )
        for name, planner in in_text.OTHER_PLANNERS.items()
    ),
}
