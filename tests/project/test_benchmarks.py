"""The page on performance says what was measured, and what was measured is complete."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def at_root(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(ROOT))


def test_every_row_was_measured_or_says_why_not_and_is_shown():
    from benchmarks.results import load
    from benchmarks.rows import ROWS, SIDES

    records = load().records
    assert [record.name for record in records] == [row.name for row in ROWS]
    assert {side for row in ROWS for side in (row.ours, row.peer) if side} == set(SIDES)
    text = (ROOT / "docs" / "performance.md").read_text("utf-8").replace("\\", "")
    for record in records:
        assert record.name in text
        if record.ours is None:
            assert record.note.startswith("Not measured: ")
        else:
            assert (record.peer is None) == (record.ratio is None)
            assert (record.target is None) == (record.met is None)


def test_a_ratio_is_formed_within_each_round():
    from benchmarks.results import Target, record

    target = Target(of="ratio", sense="at least", value=2.5)
    found = record("x", "1/s", [10.0, 20.0, 40.0], [5.0, 5.0, 40.0], "peer", target)
    assert (found.ours, found.peer) == (20.0, 5.0)
    assert (found.ratio, found.low, found.high) == (2.0, 1.0, 4.0)
    assert found.met is False
    assert record("x", "ms", [2.0], [6.0], "peer").ratio == 3.0


def test_the_model_that_peers_are_given_is_ours():
    from benchmarks import planning
    from benchmarks.peers import rows

    theirs = rows.positions(rows.RowsModel())
    pairs = zip(planning.positions(), theirs, strict=True)
    assert max(abs(ours - peer) for ours, peer in pairs) < 1e-3
