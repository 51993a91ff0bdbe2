"""From which fault frequency on a repair pays, as the paper works it out (Table V)."""

from dataclasses import dataclass

import numpy as np

from faultpath.stats.contrast import Contrast, percentile_interval
from faultpath.stats.inputs import Floats
from faultpath_paper.cells import Cell
from faultpath_paper.detection import enough
from faultpath_paper.quantities.differences import together
from faultpath_paper.results import Quantity, Results, decisive

Repair = tuple[Cell, Cell, Cell, Cell]
"""Repair and baseline under correct inputs, then both under the fault."""


@dataclass(frozen=True)
class Crossing:
    """Effects of a repair under correct inputs and under the fault, and where it breaks even."""

    correct: Contrast
    faulty: Contrast
    value: float | None
    """Fault frequency in percent above which the repair is ahead; `None` without one."""
    interval: tuple[float, float] | None
    """Percentile interval over joint resamples; one without such a frequency counts as 100."""

    @property
    def behind_throughout(self) -> bool:
        """Whether the repair is behind at every frequency, by the estimates."""
        return max(self.correct.value, self.faulty.value) < 0


def crossing(results: Results, repair: Repair) -> Crossing:
    """Return where a repair breaks even, over the same resamples of paired scenes."""
    own, baseline, faulty_own, faulty_baseline = repair
    correct, faulty = together(results, (own, baseline), (faulty_own, faulty_baseline))
    value = float(_break_even(np.array([correct.value]), np.array([faulty.value]))[0])
    drawn = np.nan_to_num(_break_even(correct.draws, faulty.draws), nan=100.0)
    return Crossing(
        correct=correct,
        faulty=faulty,
        value=None if np.isnan(value) else value,
        interval=percentile_interval(drawn) if enough(correct) else None,
    )


def _break_even(correct: Floats, faulty: Floats) -> Floats:
    """Return -Δ0 / (Δf - Δ0) in percent, 0 where neither is negative, and NaN without a crossing
    above which the repair is ahead."""
    percent = np.full(correct.shape, np.nan)
    percent[(correct >= 0) & (faulty >= 0)] = 0.0
    crosses = (correct < 0) & (faulty > 0)
    percent[crosses] = 100.0 * correct[crosses] / (correct[crosses] - faulty[crosses])
    return percent


def greater_effect(repair: Repair) -> Quantity:
    """Return the greater of a repair's two effects: with it the repair is behind throughout."""

    def quantity(results: Results) -> Contrast:
        tradeoff = crossing(results, repair)
        value = max(tradeoff.correct.value, tradeoff.faulty.value)
        draws = np.maximum(tradeoff.correct.draws, tradeoff.faulty.draws)
        n_scenes = tradeoff.correct.n_scenes
        return decisive(Contrast(value, "pp", n_scenes, draws=draws, against_zero=False))

    return quantity
