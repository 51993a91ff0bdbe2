"""The word that the table of all audits has for what an isolated test says of deployment."""

import comparison
import pytest
from comparison import ALONE, MISSED, OPEN, REVERSAL, SAME, SIZE, Effect, verdict
from documents import BLOCKS


@pytest.mark.parametrize(
    ("alone", "shared", "turn", "word"),
    [
        (1, -1, "reversal", REVERSAL),
        (0, -1, "interaction", MISSED),
        (-1, 0, "interaction", ALONE),
        (1, 1, "interaction", SIZE),
        (1, 1, "none", SAME),
        (1, 0, "none", OPEN),
        (0, 0, "interaction", OPEN),
    ],
)
def test_only_what_is_decided_makes_a_word(alone, shared, turn, word) -> None:
    effects = (Effect(-30.0, -40.0, 40.0, sign) for sign in (alone, shared))
    assert verdict(*effects, turn) == word


def test_the_table_has_every_audit_and_the_module_that_says_least() -> None:
    head, _, *rows = BLOCKS["found"]().splitlines()
    groups = comparison.grouped()
    assert sum(map(len, groups)) == len([*comparison.every_audit()]) > len(comparison.PAGES)
    for group in groups:
        assert len({(audit.word, audit.effects["shared"].sign) for audit in group}) == 1
    assert len(rows) == len(groups)
    assert all(row.count("|") == head.count("|") for row in rows)
    docking = next(row for row in rows if "`ranges`" in row)
    assert "| speedometer **" in docking
    assert docking.endswith("| **reversal** |")


def test_the_counts_are_those_of_all_audits() -> None:
    *systems, total = (row.split("|")[2:-1] for row in BLOCKS["counts"]().splitlines()[2:])
    numbers = [[int(cell.strip() or 0) for cell in row] for row in (*systems, total)]
    assert all(row[0] == sum(row[1:]) for row in numbers)
    assert [sum(column) for column in zip(*numbers[:-1], strict=True)] == numbers[-1]
    assert numbers[-1][0] == sum(map(len, comparison.grouped()))
