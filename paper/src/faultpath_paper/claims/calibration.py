"""C05 to C15: calibration errors and training on them (paper, Table II, Figure 3 and text)."""

from faultpath_paper.cells import Cell, Printed, published
from faultpath_paper.claims.rules import (
    ABOVE,
    BELOW,
    NO_LOSS,
    REPORTED,
    Rule,
    at_least,
    at_most,
    by_point,
)
from faultpath_paper.claims.statement import Statement, Statements, stated
from faultpath_paper.pages import figure_3, in_text, table_2
from faultpath_paper.quantities.differences import combined, rate, success
from faultpath_paper.quantities.summaries import at_lower_success, range_gained, worst
from faultpath_paper.quantities.windows import ratio

FAULTS = (0.1, -0.1)
WM_A, WM_U = table_2.PAIRS
REPAIR, BASELINE = WM_A
PLUS, MINUS = ((table_2.cell(BASELINE, e), (table_2.error_under(e),)) for e in FAULTS)
"""Success and prediction error of WM-A under each error."""
_NOISY = published("in_text", "state_noise_and_delay_correct_calibration")


def _under(model: str, error: float) -> tuple[Cell, Cell]:
    return table_2.cell(model, error), table_2.cell(model, 0.0)


def _under_in_paper(model: str, error: float) -> float:
    return table_2.paper_rate(model, error) - table_2.paper_rate(model, 0.0)


def _error_at_lower_success_in_paper() -> float:
    seed_0 = published("table_2_calibration", "WM-A_seed0")
    minus, _, plus = sorted(zip(table_2.ERRORS, seed_0["success"], seed_0["error_cm"], strict=True))
    less, more = sorted((minus[1:], plus[1:]))
    return 0.01 * (less[1] - more[1])


def _repaired(pair: tuple[str, str], error: float) -> Statement:
    repair, baseline = pair
    return stated(
        f"success of {repair.upper()} minus {baseline.upper()} at e = {error:+g}",
        success(table_2.cell(repair, error), table_2.cell(baseline, error)),
        ABOVE,
        table_2.paper_repair(baseline, error),
    )


def _noisy(error: float) -> tuple[Cell, Cell]:
    return in_text.noisy(REPAIR, error), in_text.noisy(BASELINE, error)


def _responds(
    first: str, second: str, probe: str, rule: Rule, paper: Printed | None = None
) -> Statement:
    return stated(
        f"median response of {first.upper()} to the {probe} probe over that of {second.upper()}",
        ratio((in_text.response(first, probe),), (in_text.response(second, probe),)),
        rule,
        paper,
    )


def _response_in_paper(first: str, probe: str, second: str) -> Printed:
    key = f"probe_WM-A_{probe.replace(' ', '_')}_response_cm"
    responses_cm = dict(zip((BASELINE, REPAIR), published("in_text", key).values(), strict=True))
    return Printed(responses_cm[first] / responses_cm[second])


CLAIMS: dict[str, Statements] = {
    **{
        claim: (
            stated(
                f"success of WM-A at e = {error:+g} minus at e = 0",
                success(*_under(BASELINE, error)),
                at_most(-lost_pp, seen=True),
                Printed(_under_in_paper(BASELINE, error)),
            ),
        )
        for claim, error, lost_pp in (("C05", 0.1, 30), ("C06", -0.1, 20))
    },
    "C07": (
        stated(
            "success of WM-U at e = +0.1 minus at e = 0",
            success(*_under(WM_U[1], 0.1)),
            BELOW,
            Printed(_under_in_paper(WM_U[1], 0.1)),
        ),
        stated(
            "success of WM-A at e = +0.1 minus at e = 0, minus that of WM-U,",
            combined((1, _under(BASELINE, 0.1)), (-1, _under(WM_U[1], 0.1))),
            by_point(-1),
            Printed(_under_in_paper(BASELINE, 0.1) - _under_in_paper(WM_U[1], 0.1)),
        ),
    ),
    "C08": (
        stated(
            "success of WM-U at e = -0.1 minus at e = 0, minus a third of the same at e = +0.1,",
            combined((1, _under(WM_U[1], -0.1)), (-1 / 3, _under(WM_U[1], 0.1))),
            by_point(1),
            Printed(_under_in_paper(WM_U[1], -0.1) - _under_in_paper(WM_U[1], 0.1) / 3),
        ),
    ),
    "C09": tuple(_repaired(WM_A, error) for error in FAULTS),
    "C10": (_repaired(WM_U, 0.1),),
    "C11": tuple(
        stated(
            f"success of {repair.upper()} minus {baseline.upper()} at e = 0",
            success(table_2.cell(repair, 0.0), table_2.cell(baseline, 0.0)),
            NO_LOSS,
            table_2.paper_repair(baseline, 0.0),
        )
        for repair, baseline in table_2.PAIRS
    ),
    "C12": (
        stated(
            "median error of WM-A at the sign with less success, minus at the other,",
            at_lower_success(PLUS, MINUS, 0.5),
            by_point(-1),
            Printed(_error_at_lower_success_in_paper()),
        ),
        stated(
            "90th percentile of that error at the sign with less success, minus at the other,",
            at_lower_success(PLUS, MINUS, 0.9),
            by_point(1),
        ),
    ),
    "C13": (
        stated(
            "worst success of WM-U+DCC over the sweep, in percent,",
            worst(WM_U[0]),
            by_point(1, 99, strict=False),
        ),
        stated(
            "number of errors around 0 with success of 90 and more, WM-A+DCC minus WM-A,",
            range_gained(*WM_A),
            by_point(1),
        ),
        stated(
            f"success of WM-A+DCC at e = {figure_3.ERRORS[0]:g}, in percent,",
            rate(figure_3.cell(REPAIR, figure_3.ERRORS[0])),
            by_point(-1, 50),
        ),
    ),
    "C14": (
        _responds(
            BASELINE,
            REPAIR,
            "calibration",
            at_least(3),
            _response_in_paper(BASELINE, "calibration", REPAIR),
        ),
        _responds(
            REPAIR,
            BASELINE,
            "history shuffle",
            at_least(2),
            _response_in_paper(REPAIR, "history shuffle", BASELINE),
        ),
        _responds(REPAIR, BASELINE, "history exchange", REPORTED),
    ),
    "C15": (
        *(
            stated(
                f"success of WM-A+DCC minus WM-A with noise and delay at e = {error:+g}",
                success(*_noisy(error)),
                ABOVE,
            )
            for error in FAULTS
        ),
        stated(
            "success of WM-A+DCC minus WM-A with noise and delay at e = 0",
            success(*_noisy(0.0)),
            BELOW,
            Printed(_NOISY[table_2.NAMES[REPAIR]] - _NOISY[table_2.NAMES[BASELINE]]),
        ),
    ),
}
