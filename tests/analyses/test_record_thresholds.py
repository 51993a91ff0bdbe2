"""A metric beside success, and success by thresholds of it: told, never decided."""

from dataclasses import replace

import pytest
from outcome_tables import conditions, facts, question, record, table
from rich.console import Console

from faultpath.analyses.audit import audit_analysis
from faultpath.analyses.decide import decide
from faultpath.core.errors import UserError
from faultpath.report.audit_tables import markdown_table
from faultpath.report.sentences import words
from faultpath.report.terminal import decision
from faultpath.run.plan import SystemSpec
from faultpath.run.question import AuditQuestion, ask
from faultpath.run.registry import load_system
from faultpath.run.trials import Trials
from faultpath.system import Metric, Status

CELLS = {"correct": (96, 2, 2), "shared": (30, 40, 10)}
TOY = SystemSpec(name="examples/toy.py:create")


def told(better: str, values: dict[str, float], *thresholds: float):
    """Return the record of a metric that grows with the scene and is larger in one variant."""
    rows = []
    for row in table(CELLS):
        error = {"error": values[row.variant] + row.scene_index / 100}
        rows.append(replace(row, outcome=replace(row.outcome, metrics=error)))
    metrics = {"error": Metric(unit="rad", better=better)}
    asked = question(metric="error", thresholds=thresholds)
    return decide(asked, facts(metrics=metrics), conditions(*CELLS), Trials.of(rows))


@pytest.mark.parametrize("better", ["less", "more"])
def test_success_at_a_threshold_is_no_crash_and_a_metric_that_is_good_enough(better):
    offset = {"old": 0.0, "new": 0.25}
    thresholds = told(better, offset, 0.5)
    percent = dict.fromkeys(offset, 0)
    for row in table(CELLS):
        error = offset[row.variant] + row.scene_index / 100
        good = error <= 0.5 if better == "less" else error >= 0.5
        if row.condition == "correct" and row.outcome.status is not Status.CRASH:
            percent[row.variant] += good
    (at,) = thresholds.secondary[0].thresholds
    assert (at.baseline_percent, at.repair_percent) == (percent["old"], percent["new"])
    assert at.difference.value == pytest.approx(percent["new"] - percent["old"])
    assert thresholds.secondary[0].metric_means == pytest.approx((0.495, 0.745))
    assert thresholds.secondary[0].metrics["error"].unit == "rad"


@pytest.mark.parametrize(("more", "shown"), [(0.0017, "+0.0017"), (12.0, "+12"), (0.0, "0.00")])
def test_a_metric_is_in_one_table_with_as_many_digits_as_it_needs(more, shown):
    text = markdown_table(told("less", {"old": 0.0, "new": more}, 0.5))
    assert text.count("Secondary, not tested") == 1
    (metric,) = (line for line in text.splitlines() if line.startswith("| error (rad), old → new"))
    assert metric.count(f", {shown} ") == 2
    assert text.count("success if error ≤ 0.5 rad") == 1


def test_the_terminal_shows_a_metric_with_a_row_for_each_condition():
    console = Console(width=80)
    with console.capture() as captured:
        console.print(decision(told("less", {"old": 0.0, "new": 0.25}, 0.5)))
    text = captured.get()
    rows = text[text.index("Secondary, not tested") :].splitlines()
    assert any(row.startswith("correct") and "0.74, +0.25" in row for row in rows), text


def test_nothing_that_is_decided_depends_on_it():
    plain = record(CELLS)
    found = told("less", {"old": 0.0, "new": 0.25}, 0.1, 0.5)
    for one, two in zip(found.effects, plain.effects, strict=True):
        assert one == two
    assert words(found).headline == words(plain).headline


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"metric": "speed"}, "unknown metric 'speed'; known: terminal_distance_m"),
        ({"thresholds": (0.1,)}, "thresholds of what"),
        (
            {"metric": "terminal_distance_m", "thresholds": (float("nan"),)},
            "thresholds.*finite number",
        ),
    ],
)
def test_what_the_system_does_not_measure_is_refused(asked, said, monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)
    system = load_system(TOY)
    variants = {"baseline": "calibrated", "repair": "blind", "fault": "gain:scale=0.6"}
    with pytest.raises(UserError, match=said):
        audit_analysis(system, TOY, ask(AuditQuestion, variants | asked), system.library("carts"))
