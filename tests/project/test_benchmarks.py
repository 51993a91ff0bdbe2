"""The page on performance says what was measured, and what was measured is complete."""

import json
import re
from pathlib import Path

from documents import BLOCKS

from benchmarks import cost, physics, planning
from benchmarks.peers import batched
from benchmarks.results import DEVICE, LOOP_STEPS, TAPS, Target, load, record
from benchmarks.rows import ROWS, SIDES

ROOT = Path(__file__).parents[2]


def test_every_row_was_measured_or_says_why_not_and_is_shown():
    records = load().records
    assert [entry.name for entry in records] == [row.name for row in ROWS]
    assert {side for row in ROWS for side in (row.ours, row.peer) if side} == set(SIDES)
    text = (ROOT / "docs" / "performance.md").read_text("utf-8").replace("\\", "")
    for entry in records:
        assert entry.name in text
        if entry.ours is None:
            assert entry.note.startswith("Not measured: ")
        else:
            assert (entry.peer is None) == (entry.ratio is None)
            assert (entry.target is None) == (entry.met is None)


def test_sizes_in_the_text_are_those_that_are_measured():
    text = (ROOT / "benchmarks" / "README.md").read_text("utf-8")
    words = re.sub(r"<!-- begin:(\S+) -->.*?<!-- end:\1 -->", "", text, flags=re.DOTALL).split()
    scenes, seeds = physics.outcomes()[0].shape
    for sizes in (
        f"{planning.CANDIDATES} candidates, {planning.HORIZON} steps",
        f"{physics.VEHICLES} vehicles",
        f"{physics.SCENES} selection scenes",
        f"{scenes} scenes and {seeds} seeds with {physics.RESAMPLES:,} resamples",
        f"{TAPS} taps",
        f"an audit of {cost.SCENES} scenes",
        f"a CSV file of {cost.JUDGED:,} scenes",
        f"the audit of {cost.AUDITED:,} scenes",
    ):
        assert sizes in " ".join(words)


def test_the_loop_s_row_tells_what_a_tap_costs(monkeypatch):
    loop = record("Loop", LOOP_STEPS, [2000.0], [10_000.0], "bare loop")
    results = load().model_copy(update={"records": (loop,)})
    monkeypatch.setattr("benchmarks.results.load", lambda: results)
    table = BLOCKS["performance:rows"]()
    assert "| Loop | 500 µs a step | 100 (bare loop) | 0.2" in table
    assert "- Loop: 40 µs a tap and step more than the bare loop, at 10 taps" in table


def test_every_figure_of_a_gpu_names_its_command_or_says_that_it_was_entered_by_hand():
    text = BLOCKS["performance:gpu"]()
    for figures in json.loads(DEVICE.read_text("utf-8")).values():
        for part in (figures, figures.get("audits"), figures.get("paper")):
            if part is not None:
                assert (part.get("command") or part["by_hand"]) in text


def test_a_ratio_is_formed_within_each_round():
    target = Target(of="ratio", sense="at least", value=2.5)
    result = record("x", "1/s", [10.0, 20.0, 40.0], [5.0, 5.0, 40.0], "peer", target)
    assert (result.ours, result.peer, result.met) == (20.0, 5.0, False)
    assert (result.ratio, result.low, result.high) == (2.0, 1.0, 4.0)
    assert record("x", "ms", [2.0], [6.0], "peer").ratio == 3.0


def test_the_model_that_peers_are_given_is_ours():
    theirs = batched.positions(batched.BatchModel())
    pairs = zip(planning.positions(), theirs, strict=True)
    assert max(abs(ours - peer) for ours, peer in pairs) < 1e-3
