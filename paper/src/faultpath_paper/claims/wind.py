"""C16 to C22, C43 and C45: wind that no sensor measures (paper, Table III and text)."""

from dataclasses import replace

from faultpath_paper.cells import Printed, published
from faultpath_paper.claims.rules import ABOVE, BELOW, NO_DIFFERENCE, NO_GAIN, Rule, by_point
from faultpath_paper.claims.statement import Statement, Statements, stated
from faultpath_paper.pages import in_text
from faultpath_paper.pages.table_3 import (
    ENVIRONMENTS,
    GRU,
    TRAJECTORY,
    TRUE,
    WITHHELD,
    ZERO,
    ZERO_OF_EVERY_SEED,
    cell,
    paper_rate,
)
from faultpath_paper.quantities.differences import success
from faultpath_paper.quantities.windows import difference_of_quantiles

OBSTACLES = "obstacles"

_FROZEN = published("in_text", "freeze_reconstructed_wind_at_step_20")


Row = tuple[str, str, str]
"""Variant, environment and wind level of an entry of Table III."""


def _gap(words: str, first: Row, second: Row, rule: Rule) -> Statement:
    """Compare two entries of Table III: success of the first minus the second."""
    paper = Printed(paper_rate(*first) - paper_rate(*second))
    return stated(words, success(cell(*first), cell(*second)), rule, paper)


def _l3(variant: str) -> Row:
    return variant, OBSTACLES, "L3"


CLAIMS: dict[str, Statements] = {
    "C16": tuple(
        stated(
            f"median error of {low} minus that of {high}",
            difference_of_quantiles((in_text.windy_error(first),), (in_text.windy_error(second),)),
            by_point(-1),
        )
        for (low, first), (high, second) in (
            (("ground-truth wind", f"wm-a-wind/{TRUE}"), ("the wind-withheld model", WITHHELD)),
            (("the wind-withheld model", WITHHELD), ("zero wind", ZERO_OF_EVERY_SEED)),
        )
    ),
    "C17": tuple(
        _gap(
            f"success of zero wind minus the wind-withheld model at {level}, {environment},",
            (ZERO, environment, level),
            (WITHHELD, environment, level),
            NO_GAIN,
        )
        for environment in ENVIRONMENTS
        for level in ("L2", "L3")
    ),
    "C18": tuple(
        _gap(
            f"success of ground-truth wind minus zero wind at L3, {environment}",
            (TRUE, environment, "L3"),
            (ZERO, environment, "L3"),
            ABOVE,
        )
        for environment in ENVIRONMENTS
    ),
    "C19": (
        _gap("success of GRU minus ground-truth wind at L3", _l3(GRU), _l3(TRUE), NO_DIFFERENCE),
        _gap("success of GRU minus zero wind at L3", _l3(GRU), _l3(ZERO), ABOVE),
    ),
    "C20": (
        stated(
            "success of GRU minus zero wind at L3 with noise and delay",
            success(in_text.noisy_wind(GRU), in_text.noisy_wind(ZERO)),
            ABOVE,
        ),
    ),
    "C21": (
        stated(
            "success with the reconstructed wind frozen minus updated, free space at L3",
            success(in_text.WIND_FROZEN, in_text.WIND_UPDATED),
            BELOW,
            Printed(_FROZEN["after"] - _FROZEN["before"]),
        ),
    ),
    "C22": (
        _gap(
            "success of the trajectory-trained GRU minus the collection-trained one at L3",
            _l3(TRAJECTORY),
            _l3(GRU),
            by_point(-1),
        ),
    ),
    "C43": (
        stated(
            "success of the trajectory-trained GRU minus zero wind at L0",
            success(in_text.TRAJECTORY_STILL, cell(ZERO, OBSTACLES, "L0")),
            by_point(-1),
            Printed(paper_rate(TRAJECTORY, OBSTACLES, "L0") - paper_rate(ZERO, OBSTACLES, "L0")),
        ),
    ),
    # The paper sets one flight of a frozen wind beside the mean over all seeds of the zero input.
    "C45": (
        stated(
            "success with the reconstructed wind frozen minus zero wind, free space at L3",
            success(replace(in_text.WIND_FROZEN, fixed=True), cell(ZERO, "free-space", "L3")),
            by_point(-1),
            Printed(_FROZEN["after"] - paper_rate(ZERO, "free-space", "L3")),
        ),
    ),
}
