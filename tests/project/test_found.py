"""The word that the table of all audits has for what an isolated test says of deployment."""

import re

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


def test_every_system_has_a_row_that_counts_its_audits() -> None:
    rows = [row.split("|")[2:-1] for row in BLOCKS["counts"]().splitlines()[2:]]
    assert sum(int(audits) for audits, _ in rows) == sum(map(len, comparison.grouped()))
    for audits, answer in rows:
        counts = [int(text) for text in re.findall(r"\((\d+)\)", answer)]
        assert sum(counts) == (int(audits) if int(audits) > 1 else 0)


def test_teaching_examples_are_marked() -> None:
    marked = [system for system in comparison.by_system() if "(teaching example)" in system]
    assert len(marked) == len(comparison.TEACHING)
    assert any("Cart" in system for system in marked)


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        ([REVERSAL], "no: the better version is the worse one"),
        ([OPEN, ALONE, OPEN], "no: the difference that it shows is gone (1); inconclusive (2)"),
    ],
)
def test_an_answer_counts_only_several_audits(words, answer) -> None:
    assert comparison.answer(words) == answer
