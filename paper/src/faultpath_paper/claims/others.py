"""C36 to C39: withheld calibration, frozen histories, planning and perception (paper, text)."""

from faultpath_paper.cells import Printed, of_seed, published
from faultpath_paper.claims.rules import NO_GAIN, NO_LOSS, REPORTED, at_least, by_point
from faultpath_paper.claims.statement import Statements, stated
from faultpath_paper.pages import in_text, table_4, table_6
from faultpath_paper.quantities.differences import success
from faultpath_paper.quantities.summaries import share

GRU, DCC = (of_seed(table_4.cell(method, "correct")) for method in ("gru", "gru+dcc"))
_PAPER = published("in_text")
_NOMINAL = table_6.paper_negative("gru", "correct")
"""Success of seed 0, as of the paper's GRU without calibration, percent."""


def _frozen(key: str) -> Printed:
    frozen, updated = _PAPER["freeze_history_encoding"][key]
    return Printed(frozen - updated)


CLAIMS: dict[str, Statements] = {
    "C36": (
        stated(
            "success of the GRU without calibration minus GRU, correct inputs, seed 0,",
            success(in_text.CALIBRATION_WITHHELD, GRU),
            by_point(-1),
            Printed(_PAPER["reconstruction_without_calibration_success"] - _NOMINAL),
        ),
        stated(
            "success of GRU+DCC minus GRU, correct inputs, seed 0",
            success(DCC, GRU),
            REPORTED,
            Printed(table_6.paper_negative("gru+dcc", "correct") - _NOMINAL),
        ),
    ),
    "C37": (
        stated(
            "success of WM-A+DCC with the history code frozen minus updated, e = +0.1,",
            success(in_text.CODE_FROZEN, in_text.CODE_UPDATED),
            NO_LOSS,
            _frozen("WM-A+DCC obstacles e=+0.1"),
        ),
        stated(
            "success of the wind-withheld model with the code frozen minus updated, L3,",
            success(in_text.WITHHELD_FROZEN, in_text.WITHHELD_UPDATED),
            NO_LOSS,
            _frozen("wind-withheld free space L3"),
        ),
    ),
    "C38": (
        stated(
            "percentage of scenes that succeed in all eight configurations",
            share(in_text.CEILING, True),
            at_least(50),
            Printed(_PAPER["ceiling_eight_configurations"]["succeed_in_all"]),
        ),
        stated(
            "percentage of scenes that fail in all eight configurations",
            share(in_text.CEILING, False),
            at_least(10),
            Printed(_PAPER["ceiling_eight_configurations"]["fail_in_all"]),
        ),
    ),
    "C39": tuple(
        stated(
            f"success with {name} minus the reference planner",
            success(planner, in_text.REFERENCE_PLANNER, other_noise=True),
            NO_GAIN,
        )
        for name, planner in in_text.OTHER_PLANNERS.items()
    ),
}
