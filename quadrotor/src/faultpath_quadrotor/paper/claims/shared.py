"""C23 to C29 and C32: errors at the reconstruction alone, and shared (paper, Tables IV and VI)."""

from faultpath_quadrotor.paper.cells import Cell, Printed, published
from faultpath_quadrotor.paper.claims.rules import ABOVE, BELOW, NO_LOSS, Rule, by_point
from faultpath_quadrotor.paper.claims.statement import (
    ALL_SEEDS,
    Statement,
    Statements,
    TurnsDown,
    seeds_that_turn,
)
from faultpath_quadrotor.paper.pages.table_4 import cell, change, paper_contrast, paper_rate
from faultpath_quadrotor.paper.pages.table_6 import negative, paper_negative
from faultpath_quadrotor.paper.quantities.differences import success, terminal_distance

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


_FARTHER = published(
    "table_4_shared_calibration", "terminal_distance_GRU+DCC_minus_GRU_m", "shared_minus_isolated"
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
            Printed(_FARTHER["mean"], tuple(_FARTHER["ci95"])),
        ),
    ),
    "C28": (
        _between_paths(DOB, ISOLATED, CORRECT, BELOW),
        _between_paths(DOB, SHARED, ISOLATED, ABOVE),
        _between_methods(DOB, GRU, SHARED, NO_LOSS),
    ),
    "C29": (
        _between_methods(DOB, DCC, ISOLATED, BELOW),
        _between_methods(DOB, DCC, SHARED, ABOVE),
    ),
    "C32": tuple(
        Statement(
            f"success of GRU+DCC minus GRU at the negative offset, {path},",
            success(negative(DCC, path), negative(GRU, path)),
            rule,
            Printed(paper_negative(DCC, path) - paper_negative(GRU, path)),
        )
        for path, rule in ((ISOLATED, by_point(1, strict=False)), (SHARED, by_point(-1)))
    ),
}
