"""Sizes: how an estimate stands to the paper's figure, beside answers that do not know it."""

import pytest
from faultpath_paper.cells import Printed
from faultpath_paper.claims import STATEMENTS
from faultpath_paper.claims.statement import size

EXACT, MEASURED = Printed(10.0), Printed(10.0, (4.0, 16.0))
UNPRINTED = {
    ("C12", 1),  # 90th percentile
    *(("C13", at) for at in range(3)),  # of Figure 3
    ("C14", 2),
    *(("C15", at) for at in range(2)),  # under an error
    *(("C16", at) for at in range(2)),  # an ordering
    ("C20", 0),
    ("C26", 1),  # seeds are counted
    ("C33", 3),  # no crossing
    ("C35", 0),
    *(("C39", at) for at in range(3)),
}
"""Statements for which the paper prints no figure, by claim and place."""


@pytest.mark.parametrize(
    ("value", "interval", "paper", "expected"),
    [
        (12.0, (10.0, 14.0), EXACT, "compatible"),
        (10.0, (10.0, 10.0), EXACT, "compatible"),
        (12.0, (10.1, 14.0), EXACT, "right sign, other size"),
        (5.0, (1.0, 9.0), EXACT, "right sign, other size"),
        (4.0, (-1.0, 9.0), EXACT, "other size"),
        (-4.0, (-7.0, -1.0), EXACT, "other sign"),
        (4.0, (1.0, 7.0), Printed(0.0), "other size"),
        # Both have errors: 10 apart, and hypot(8, 6) is 10.
        (20.0, (12.0, 28.0), MEASURED, "compatible"),
        (20.1, (12.1, 28.1), MEASURED, "right sign, other size"),
        # Overlap is not enough: 16 lies in both.
        (22.0, (16.0, 28.0), MEASURED, "right sign, other size"),
        (-20.0, (-26.0, -14.0), MEASURED, "other sign"),
        (40.0, (30.0, 50.0), Printed(1.0, (-2.0, 4.0)), "other size"),
        # Only the sides that face each other count.
        (20.0, (18.0, 60.0), Printed(10.0, (-60.0, 12.0)), "other size"),
        (20.0, (18.0, 60.0), Printed(10.0, (1.0, 12.0)), "right sign, other size"),
    ],
)
def test_an_estimate_stands_to_a_figure(value, interval, paper, expected):
    assert size(value, interval, 100, paper, 0.0) == expected
    low, high = interval
    ends = paper.interval and (-paper.interval[1], -paper.interval[0])
    assert size(-value, (-high, -low), 100, Printed(-paper.value, ends), 0.0) == expected


def test_a_ratio_has_its_sides_about_1_and_a_share_has_none() -> None:
    assert size(0.5, (0.4, 0.6), 100, Printed(0.8), 1.0) == "right sign, other size"
    assert size(0.5, (0.4, 0.6), 100, Printed(1.2), 1.0) == "other sign"
    assert size(60.0, (50.0, 70.0), 100, Printed(80.0), None) == "other size"


def test_where_the_papers_figures_come_true_sizes_are_compatible(answers):
    """The toy's windows are noisier than its intervals in two medians; all else is as printed."""
    parts = [(claim.id, at, p) for claim in answers.values() for at, p in enumerate(claim.parts)]
    others = [
        (claim, at) for claim, at, p in parts if p.paper is not None and p.size != "compatible"
    ]
    assert others == [("C12", 0), ("C30", 7), ("C34", 0), ("C34", 1)]


def test_every_figure_that_the_paper_prints_is_carried_with_the_sign_that_a_claim_states() -> None:
    """A figure with its terms in the wrong order would contradict its own claim."""
    every = [(claim, at, s) for claim, of in STATEMENTS.items() for at, s in enumerate(of)]
    assert {(claim, at) for claim, at, s in every if s.paper is None} == UNPRINTED
    checked = 0
    for *_, statement in every:
        words = statement.words.removesuffix(", by the point estimate")
        side = words.endswith(" above 0") - words.endswith(" below 0")
        if side and statement.paper and "not significantly" not in words:
            assert statement.paper.value * side > 0, statement.words
            checked += 1
    assert checked > 25
