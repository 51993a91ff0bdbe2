"""C30, C31, C34, C35, C40: how a biased reconstruction makes up for a wrong model (Table VI)."""

from faultpath_paper.cells import Printed, published
from faultpath_paper.claims.rules import NO_LOSS, Rule, at_least, by_point, less_than, within
from faultpath_paper.claims.statement import Statement, Statements, stated
from faultpath_paper.pages import in_text, table_4, table_6
from faultpath_paper.quantities.summaries import rank_correlation
from faultpath_paper.quantities.windows import (
    Subject,
    difference_of_changes,
    difference_of_quantiles,
    median,
    ratio,
)

NOMINAL, ISOLATED, PREDICTOR, SHARED = table_6.INTERFACES
GRU, DCC, DOB = table_4.METHODS
WITHIN_15_PERCENT = within(0.85, 1.15)
_printed = table_6.paper_acceleration
_WIND_TERM = published(
    "table_6_compensation", "a_analytic_acceleration_error_mps2", "GRU_wind_term_only"
)
_CORRELATIONS = published("in_text", "spearman_success")


def _acceleration(method: str, interface: str) -> Subject:
    return table_6.errors("acceleration-error", method, interface)


def _over_nominal(method: str, interface: str, rule: Rule) -> Statement:
    return stated(
        f"acceleration error of {method.upper()}, {interface} over correct,",
        ratio(_acceleration(method, interface), _acceleration(method, NOMINAL)),
        rule,
        Printed(_printed(method, interface) / _printed(method, NOMINAL)),
    )


def _repair_moves_less(what: str, other: str, first: str, second: str, *, size: bool) -> Statement:
    """State that GRU+DCC changes less than another method from one interface to another."""
    repair, rival = (
        (_acceleration(method, first), _acceleration(method, second)) for method in (DCC, other)
    )
    changes = [_printed(method, second) - _printed(method, first) for method in (DCC, other)]
    own, others = map(abs, changes) if size else changes
    return stated(
        f"{what} in acceleration error, GRU+DCC minus {other.upper()},",
        difference_of_changes(repair, rival, size=size),
        by_point(-1),
        Printed(own - others),
    )


CLAIMS: dict[str, Statements] = {
    "C30": (
        *(_over_nominal(method, SHARED, WITHIN_15_PERCENT) for method in (GRU, DOB)),
        *(
            _over_nominal(method, condition, at_least(1.5))
            for method in (GRU, DOB)
            for condition in (ISOLATED, PREDICTOR)
        ),
        *(
            _repair_moves_less(
                "change from correct to reconstruction-only", other, NOMINAL, ISOLATED, size=True
            )
            for other in (GRU, DOB)
        ),
        *(
            _repair_moves_less(
                "recovery from reconstruction-only to shared", other, SHARED, ISOLATED, size=False
            )
            for other in (GRU, DOB)
        ),
    ),
    "C31": (
        stated(
            "wind-term error of GRU, shared over reconstruction-only,",
            ratio(
                table_6.errors("wind-term-error", GRU, SHARED),
                table_6.errors("wind-term-error", GRU, ISOLATED),
            ),
            WITHIN_15_PERCENT,
            Printed(_WIND_TERM["shared"] / _WIND_TERM["isolated"]),
        ),
        stated(
            "acceleration error of GRU, shared over reconstruction-only,",
            ratio(_acceleration(GRU, SHARED), _acceleration(GRU, ISOLATED)),
            less_than(0.7),
            Printed(_printed(GRU, SHARED) / _printed(GRU, ISOLATED)),
        ),
    ),
    "C34": tuple(
        stated(
            f"rank correlation of success with {error} over {len(in_text.NINE)} cells",
            rank_correlation(
                [
                    (table_4.cell(method, condition), table_6.errors(quantity, method, condition))
                    for method, condition in in_text.NINE
                ]
            ),
            by_point(-1, -0.5, strict=False),
            Printed(_CORRELATIONS[key]),
        )
        for error, key, quantity in zip(
            ("acceleration error", "20-step position error"),
            ("analytic_acceleration_error", "position_error_20_step"),
            in_text.MEASURED,
            strict=True,
        )
    ),
    "C35": (
        stated(
            "median position error with GRU, shared minus reconstruction-only,",
            difference_of_quantiles(
                table_6.errors("position-error", GRU, SHARED),
                table_6.errors("position-error", GRU, ISOLATED),
            ),
            NO_LOSS,
        ),
    ),
    "C40": (
        *(
            stated(
                f"acceleration error of {method.upper()}, correct,",
                median(_acceleration(method, NOMINAL)),
                within(*limits),
                Printed(_printed(method, NOMINAL)),
            )
            for method, limits in ((DOB, (0.4, 0.7)), (GRU, (0.8, 1.4)))
        ),
        stated(
            "acceleration error of GRU over that of DOB, correct,",
            ratio(_acceleration(GRU, NOMINAL), _acceleration(DOB, NOMINAL)),
            at_least(1.5),
            Printed(_printed(GRU, NOMINAL) / _printed(DOB, NOMINAL)),
        ),
    ),
}
