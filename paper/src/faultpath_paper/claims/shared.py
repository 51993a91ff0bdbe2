"""C23 to C29, C32, C41, C42, C44: errors at the reconstruction, and shared (Tables IV and VI)."""

from collections.abc import Mapping
from typing import Any

from faultpath_paper.cells import Cell, Printed, published
from faultpath_paper.claims.rules import (
    ABOVE,
    BELOW,
    NO_DIFFERENCE,
    NO_LOSS,
    Rule,
    by_point,
)
from faultpath_paper.claims.statement import (
    ALL_SEEDS,
    Statement,
    Statements,
    TurnsDown,
    seeds_that_turn,
)
from faultpath_paper.pages.table_4 import PATHS, cell, change, paper_contrast, paper_rate
from faultpath_paper.pages.table_6 import negative, paper_negative
from faultpath_paper.quantities.differences import (
    combined,
    succeeded,
    success,
    terminal_distance,
)

CORRECT, ISOLATED, SHARED = "correct", "reconstruction-only", "shared"
GRU, DCC, DOB = "gru", "gru+dcc", "dob"


def _between_paths(method: str, first: str, second: str, rule: Rule) -> Statement:
    return Statement(
        f"success of {method.upper()}, {first} minus {second},",
        success(cell(method, first), cell(method, second)),
        rule,
        Printed(paper_rate(method, first) - paper_rate(method, second)),
    )


def _between_methods(first: str, second: str, path: str, rule: Rule) -> Statement:
    return Statement(
        f"success of {first.upper()} minus {second.upper()}, {path},",
        success(cell(first, path), cell(second, path)),
        rule,
        paper_contrast(first, second, path),
    )


def _repair(path: str) -> tuple[Cell, Cell]:
    return cell(DCC, path), cell(GRU, path)


def _negative(path: str, rule: Rule) -> Statement:
    return Statement(
        f"success of GRU+DCC minus GRU at the negative offset, {path},",
        success(negative(DCC, path), negative(GRU, path)),
        rule,
        Printed(paper_negative(DCC, path) - paper_negative(GRU, path)),
    )


_TABLE = published("table_4_shared_calibration")
_FARTHER = _TABLE["terminal_distance_GRU+DCC_minus_GRU_m"]


def _printed(figure: Mapping[str, Any]) -> Printed:
    low, high = figure["ci95"]
    return Printed(figure["mean"], (low, high))


def _farther(path: str, rule: Rule) -> Statement:
    at = list(PATHS).index(path)
    return Statement(
        f"terminal goal distance of GRU+DCC minus GRU, {path},",
        combined((1, _repair(path)), effect=terminal_distance),
        rule,
        _printed({key: _FARTHER[key][at] for key in ("mean", "ci95")}),
    )


CLAIMS: dict[str, Statements] = {
    "C23": (_between_paths(GRU, ISOLATED, CORRECT, BELOW),),
    "C24": (
        _between_paths(GRU, SHARED, ISOLATED, ABOVE),
        _between_paths(GRU, SHARED, CORRECT, NO_LOSS),
    ),
    "C25": (
        _between_methods(DCC, GRU, ISOLATED, ABOVE),
        _between_methods(DCC, GRU, CORRECT, BELOW),
    ),
    "C26": (
        TurnsDown(
            "success of GRU+DCC minus GRU, from reconstruction-only to shared,",
            _repair(ISOLATED),
            _repair(SHARED),
            Printed(
                paper_contrast(DCC, GRU, SHARED).value - paper_contrast(DCC, GRU, ISOLATED).value
            ),
        ),
        Statement(
            "number of seeds in which success of GRU+DCC minus GRU is above 0 under "
            "reconstruction-only and below 0 under shared",
            seeds_that_turn(_repair(ISOLATED), _repair(SHARED)),
            by_point(1, ALL_SEEDS, strict=False),
        ),
    ),
    "C27": (
        Statement(
            "terminal goal distance of GRU+DCC minus GRU, shared minus reconstruction-only,",
            change(DCC, GRU, terminal_distance),
            ABOVE,
            _printed(_FARTHER["shared_minus_isolated"]),
        ),
    ),
    "C28": (
        _between_paths(DOB, ISOLATED, CORRECT, BELOW),
        _between_paths(DOB, SHARED, ISOLATED, ABOVE),
        _between_methods(DOB, GRU, SHARED, NO_LOSS),
    ),
    "C29": (_between_methods(DOB, DCC, ISOLATED, BELOW), _between_methods(DOB, DCC, SHARED, ABOVE)),
    "C32": (
        _negative(ISOLATED, by_point(1)),
        _negative(SHARED, by_point(-1)),
        *(_negative(path, NO_DIFFERENCE) for path in (ISOLATED, SHARED)),
    ),
    "C41": (
        Statement(
            "success of DOB minus GRU, shared minus reconstruction-only,",
            change(DOB, GRU, succeeded),
            NO_DIFFERENCE,
            _printed(_TABLE["DOB_GRU_interaction_pp"]),
        ),
    ),
    "C42": (
        Statement(
            "success of GRU at the negative offset, shared minus correct,",
            success(negative(GRU, SHARED), negative(GRU, CORRECT)),
            by_point(-1),
            Printed(paper_negative(GRU, SHARED) - paper_negative(GRU, CORRECT)),
        ),
    ),
    "C44": (_farther(CORRECT, ABOVE), _farther(SHARED, ABOVE), _farther(ISOLATED, NO_DIFFERENCE)),
}
