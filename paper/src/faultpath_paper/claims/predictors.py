"""C01 to C04: prediction accuracy and closed-loop performance (paper, Table I)."""

from itertools import combinations

from faultpath.system import Status
from faultpath_paper.cells import Cell, Printed, of_seed
from faultpath_paper.claims.rules import ABOVE, BELOW, NO_DIFFERENCE, NO_LOSS, at_least, by_point
from faultpath_paper.claims.statement import Statements, stated
from faultpath_paper.pages import table_1
from faultpath_paper.quantities.differences import ended, success, time
from faultpath_paper.quantities.windows import Subject, difference_of_quantiles, ratio

NAMES = {
    table_1.DKI: "DKI",
    table_1.WM_A: "WM-A",
    table_1.WM_U: "WM-U",
    table_1.TRUE_PARAMETER: "the true-parameter model",
}
SEEN = {table_1.WM_A: table_1.WM_A_SEEN, table_1.TRUE_PARAMETER: table_1.TRUE_PARAMETER_SEEN}
"""Each with ground-truth clearance."""
WORSE_THAN = (
    (table_1.DKI, table_1.WM_A),
    (table_1.DKI, table_1.WM_U),
    (table_1.WM_A, table_1.TRUE_PARAMETER),
    (table_1.WM_U, table_1.TRUE_PARAMETER),
)


def _error(cell: Cell) -> Subject:
    return (table_1.common_error(cell),)


def _paper(first: Cell, second: Cell, what: str, times: float = 1.0) -> Printed:
    one, two = (table_1.PAPER[table_1.KEYS[cell]][what] for cell in (first, second))
    return Printed(times * (one - two))


CLAIMS: dict[str, Statements] = {
    "C01": (
        stated(
            "median common error of DKI over that of the true-parameter model",
            ratio(_error(table_1.DKI), _error(table_1.TRUE_PARAMETER)),
            at_least(5),
            Printed(table_1.PAPER["error_span"]),
        ),
        *(
            stated(
                f"median common error of {NAMES[worse]} minus that of {NAMES[better]}",
                difference_of_quantiles(_error(worse), _error(better)),
                by_point(1),
                _paper(worse, better, "error_common_cm", 0.01),
            )
            for worse, better in WORSE_THAN
        ),
    ),
    "C02": tuple(
        stated(
            f"success of {NAMES[first]} minus {NAMES[second]}",
            success(of_seed(first), of_seed(second)),
            NO_DIFFERENCE,
            _paper(first, second, "success"),
        )
        for first, second in combinations(table_1.PREDICTORS, 2)
    ),
    "C03": (
        stated(
            "median difference in time where both succeed, DKI minus WM-A",
            time(table_1.DKI, table_1.WM_A),
            ABOVE,
            Printed(table_1.PAPER["paired_time_minus_WM-A_s"]["DKI"]["median"]),
        ),
    ),
    "C04": tuple(
        stated(
            f"{end.value} rate of {NAMES[cell]} with ground-truth clearance minus without",
            success(seen, cell, ended(end)),
            rule,
            _paper(seen, cell, end.value),
        )
        for end, rule in ((Status.CRASH, BELOW), (Status.TIMEOUT, NO_LOSS))
        for cell, seen in SEEN.items()
    ),
}
