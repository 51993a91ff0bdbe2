"""C23 to C29, C32, C41, C42, C44: errors at the reconstruction, and shared (Tables IV and VI)."""

from collections.abc import Mapping
from typing import Any

from faultpath_paper.cells import Cell, Printed, published
from faultpath_paper.claims.rules import ABOVE, BELOW, NO_DIFFERENCE, NO_LOSS, Rule, by_point
from faultpath_paper.claims.statement import (
    ALL_SEEDS,
    Statement,
    Statements,
    seeds_that_turn,
    stated,
    turns_down,
)
from faultpath_paper.pages.table_4 import CONDITIONS, cell, change, paper_contrast, paper_rate
from faultpath_paper.pages.table_6 import negative, paper_negative
from faultpath_paper.quantities.differences import combined, succeeded, success, terminal_distance

CORRECT, ISOLATED, SHARED = "correct", "reconstruction-only", "shared"
GRU, DCC, DOB = "gru", "gru+dcc", "dob"


def _between_conditions(method: str, first: str, second: str, rule: Rule) -> Statement:
    return stated(
        f"success of {method.upper()}, {first} minus {second},",
        success(cell(method, first), cell(method, second)),
        rule,
        Printed(paper_rate(method, first) - paper_rate(method, second)),
    )


def _between_methods(first: str, second: str, condition: str, rule: Rule) -> Statement:
    return stated(
        f"success of {first.upper()} minus {second.upper()}, {condition},",
        success(cell(first, condition), cell(second, condition)),
        rule,
        paper_contrast(first, second, condition),
    )


def _repair(condition: str) -> tuple[Cell, Cell]:
    return cell(DCC, condition), cell(GRU, condition)


def _negative(condition: str, rule: Rule) -> Statement:
    return stated(
        f"success of GRU+DCC minus GRU at the negative offset, {condition},",
        success(negative(DCC, condition), negative(GRU, condition)),
        rule,
        Printed(paper_negative(DCC, condition) - paper_negative(GRU, condition)),
    )


_TABLE = published("table_4_shared_calibration")
_FARTHER = _TABLE["terminal_distance_GRU+DCC_minus_GRU_m"]


def _printed(figure: Mapping[str, Any]) -> Printed:
    low, high = figure["ci95"]
    return Printed(figure["mean"], (low, high))


def _farther(condition: str, rule: Rule) -> Statement:
    at = list(CONDITIONS).index(condition)
    return stated(
        f"terminal goal distance of GRU+DCC minus GRU, {condition},",
        combined((1, _repair(condition)), effect=terminal_distance),
        rule,
        _printed({key: _FARTHER[key][at] for key in ("mean", "ci95")}),
    )


CLAIMS: dict[str, Statements] = {
    "C23": (_between_conditions(GRU, ISOLATED, CORRECT, BELOW),),
    "C24": (
        _between_conditions(GRU, SHARED, ISOLATED, ABOVE),
        _between_conditions(GRU, SHARED, CORRECT, NO_LOSS),
    ),
    "C25": (
        _between_methods(DCC, GRU, ISOLATED, ABOVE),
        _between_methods(DCC, GRU, CORRECT, BELOW),
    ),
    "C26": (
        turns_down(
            "success of GRU+DCC minus GRU, from reconstruction-only to shared,",
            _repair(ISOLATED),
            _repair(SHARED),
            Printed(
                paper_contrast(DCC, GRU, SHARED).value - paper_contrast(DCC, GRU, ISOLATED).value
            ),
        ),
        stated(
            "number of seeds in which success of GRU+DCC minus GRU is above 0 under "
            "reconstruction-only and below 0 under shared",
            seeds_that_turn(_repair(ISOLATED), _repair(SHARED)),
            by_point(1, ALL_SEEDS, strict=False),
        ),
    ),
    "C27": (
        stated(
            "terminal goal distance of GRU+DCC minus GRU, shared minus reconstruction-only,",
            change(DCC, GRU, terminal_distance),
            ABOVE,
            _printed(_FARTHER["shared_minus_isolated"]),
        ),
    ),
    "C28": (
        _between_conditions(DOB, ISOLATED, CORRECT, BELOW),
        _between_conditions(DOB, SHARED, ISOLATED, ABOVE),
        _between_methods(DOB, GRU, SHARED, NO_LOSS),
    ),
    "C29": (_between_methods(DOB, DCC, ISOLATED, BELOW), _between_methods(DOB, DCC, SHARED, ABOVE)),
    "C32": (
        _negative(ISOLATED, by_point(1)),
        _negative(SHARED, by_point(-1)),
        *(_negative(condition, NO_DIFFERENCE) for condition in (ISOLATED, SHARED)),
    ),
    "C41": (
        stated(
            "success of DOB minus GRU, shared minus reconstruction-only,",
            change(DOB, GRU, succeeded),
            NO_DIFFERENCE,
            _printed(_TABLE["DOB_GRU_interaction_pp"]),
        ),
    ),
    "C42": (
        stated(
            "success of GRU at the negative offset, shared minus correct,",
            success(negative(GRU, SHARED), negative(GRU, CORRECT)),
            by_point(-1),
            Printed(paper_negative(GRU, SHARED) - paper_negative(GRU, CORRECT)),
        ),
    ),
    "C44": (_farther(CORRECT, ABOVE), _farther(SHARED, ABOVE), _farther(ISOLATED, NO_DIFFERENCE)),
}
