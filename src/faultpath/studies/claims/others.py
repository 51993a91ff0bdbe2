"""C36 to C39: withheld calibration, frozen histories, planning and perception (paper, text)."""

from faultpath.studies.claims.rules import BELOW, NO_GAIN, NO_LOSS, at_least, more_than
from faultpath.studies.claims.statement import Statement, Statements
from faultpath.studies.pages import in_text, table_4
from faultpath.studies.quantities.differences import Pair, combined, success
from faultpath.studies.quantities.summaries import in_all, in_none, share

SAME_ORDER = 3
"""Two costs are of the same order when neither is so many times the other: about root ten."""
GRU = table_4.cell("gru", "correct")
WITHHELD = in_text.CALIBRATION_WITHHELD
COST_OF_WITHHOLDING: Pair = (GRU, WITHHELD)
COST_OF_DCC: Pair = (GRU, table_4.cell("gru+dcc", "correct"))

CLAIMS: dict[str, Statements] = {
    "C36": (
        Statement(
            "success of the GRU without calibration minus GRU, correct inputs,",
            success(WITHHELD, GRU),
            BELOW,
        ),
        *(
            Statement(
                f"{SAME_ORDER} times the nominal cost of {small}, minus that of {large},",
                combined((SAME_ORDER, cost), (-1, other)),
                more_than(0),
            )
            for small, cost, large, other in (
                ("withholding", COST_OF_WITHHOLDING, "GRU+DCC", COST_OF_DCC),
                ("GRU+DCC", COST_OF_DCC, "withholding", COST_OF_WITHHOLDING),
            )
        ),
    ),
    "C37": (
        Statement(
            "success of WM-A+DCC with the history code frozen minus updated, e = +0.1,",
            success(in_text.CODE_FROZEN, in_text.CODE_UPDATED),
            NO_LOSS,
        ),
        Statement(
            "success of the wind-withheld model with the code frozen minus updated, L3,",
            success(in_text.WITHHELD_FROZEN, in_text.WITHHELD_UPDATED),
            NO_LOSS,
        ),
    ),
    "C38": (
        Statement(
            "percentage of scenes that succeed in all eight configurations",
            share(in_text.CEILING, in_all),
            at_least(50),
        ),
        Statement(
            "percentage of scenes that fail in all eight configurations",
            share(in_text.CEILING, in_none),
            at_least(10),
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
