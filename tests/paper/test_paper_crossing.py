"""Break-even frequencies as the paper has them: a formula, and a joint percentile bootstrap."""

from dataclasses import replace

import numpy as np
import pytest
from faultpath_paper.cells import Cell
from faultpath_paper.claims.paying import judge
from faultpath_paper.claims.rules import Range
from faultpath_paper.pages.table_5 import REPAIRS
from faultpath_paper.quantities.differences import crossing, greater_effect
from faultpath_paper.results import Results
from toy_runs import NOTHING, trials

from faultpath.stats.contrast import percentile_interval
from faultpath.stats.resamples import Resamples
from faultpath.system import Status

SCENES = 60
REPAIR = REPAIRS["GRU/reconstruction-only"]
UNDER_15, OVER_30 = Range.of("below", "15"), Range.of("above", "30")


def flown(costs: int, gains: int, scenes: int = SCENES) -> Results:
    """Let the repair lose so many scenes under correct inputs, and gain so many under the fault."""

    def ends(cell: Cell, seed: int, scene: int) -> Status:
        repair = cell.variant == "gru+dcc"
        change = gains if cell.faults else -costs
        won = scene < 20 + (change if repair else 0)
        return Status.SUCCESS if won else Status.CRASH

    return Results(trials(REPAIR, ends, range(scenes)), NOTHING, "toy")


@pytest.mark.parametrize(
    ("costs", "gains", "value", "throughout"),
    [
        (6, 12, 100 * 6 / 18, False),
        (0, 12, 0.0, False),
        (-3, 12, 0.0, False),
        (6, 0, None, False),
        (-3, -6, None, False),
        (3, -6, None, True),
        (0, 0, 0.0, False),
    ],
)
def test_a_repair_pays_above_its_break_even_frequency(costs, gains, value, throughout):
    found = crossing(flown(costs, gains), REPAIR)
    assert found.value == (None if value is None else pytest.approx(value))
    assert found.behind_throughout is throughout
    greater = greater_effect(REPAIR)(flown(costs, gains))
    assert (greater.value < 0) is throughout


def test_its_interval_is_of_joint_resamples_and_one_without_a_crossing_counts_as_100() -> None:
    found = crossing(flown(3, 3), REPAIR)
    counts = Resamples.draw("toy", SCENES).counts
    cost, gain = counts[:, 17:20].sum(axis=1), counts[:, 20:23].sum(axis=1)
    crosses = (cost > 0) & (gain > 0)
    drawn = np.where(cost == 0, 0.0, 100.0)
    drawn[crosses] = 100 * cost[crosses] / (cost + gain)[crosses]
    assert found.interval == pytest.approx(percentile_interval(drawn))
    assert found.interval == (0.0, 100.0)
    assert crossing(flown(1, 1, scenes=5), REPAIR).interval is None


@pytest.mark.parametrize(
    ("bound", "value", "behind", "scenes", "answer"),
    [
        (UNDER_15, 5.0, 0, 100, "confirmed"),
        (UNDER_15, 20.0, 0, 100, "undecided"),
        (UNDER_15, 40.0, 0, 100, "refuted"),
        (UNDER_15, 0.0, 0, 10, "confirmed"),
        (UNDER_15, 12.0, 0, 10, "undecided"),
        (UNDER_15, 0.0, 0, 5, "undecided"),
        (OVER_30, 0.0, 0, 100, "refuted"),
        (OVER_30, None, 20, 100, "refuted"),
        (OVER_30, None, 2, 100, "undecided"),
    ],
)
def test_a_break_even_frequency_meets_a_bound_or_is_none(bound, value, behind, scenes, answer):
    ends = None if value is None else (max(0.0, value - 10), value + 10)
    found = crossing(flown(0, -behind, scenes), REPAIR)
    assert judge(replace(found, value=value, interval=ends), bound).answer == answer
