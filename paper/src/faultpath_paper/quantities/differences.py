"""Quantities of paired trials: differences between cells, differences of differences, crossings.

A crossing is the fault frequency from which on a repair pays, as the paper has it (Table V).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from faultpath.run.pairing import Pairs
from faultpath.stats.contrast import Contrast, percentile_interval, weighted_sum
from faultpath.stats.decisions import with_test
from faultpath.stats.effects import mean_effect, median_effect, success_effect, success_rate
from faultpath.stats.inputs import Floats
from faultpath.stats.resamples import Resamples
from faultpath.system import Status
from faultpath_paper.cells import Cell
from faultpath_paper.detection import enough
from faultpath_paper.results import NotRun, Results, decisive, quantity

Pair: TypeAlias = tuple[Cell, Cell]
Effect: TypeAlias = Callable[[Pairs, Resamples], Contrast]
"""Comparison of paired trials."""

TELLING_PP = 20.0
"""A difference in success that a run must be able to detect for its absence to say anything."""


def ended(status: Status) -> Effect:
    """Return the difference in how many trials end in a way, with the paper's test."""

    def effect(pairs: Pairs, resamples: Resamples) -> Contrast:
        return with_test(success_effect(*pairs.ended(status), resamples, test="conditional"))

    return effect


succeeded = ended(Status.SUCCESS)


def terminal_distance(pairs: Pairs, resamples: Resamples) -> Contrast:
    """Return the mean difference in distance to the goal at the end, m, over all paired scenes."""
    distances = pairs.metric("terminal_distance_m")
    if distances is None:
        raise NotRun("a trial without a terminal distance")
    return mean_effect(*distances, resamples, "m")


def contrast(
    results: Results,
    first: Cell,
    second: Cell,
    effect: Effect = succeeded,
    *,
    other_noise: bool = False,
) -> Contrast:
    """Return the difference between two cells; `other_noise` as in `Results.pairs`."""
    pairs = results.pairs(first, second, other_noise=other_noise)
    return effect(pairs, results.resamples(pairs))


@quantity
def success(
    results: Results,
    first: Cell,
    second: Cell,
    effect: Effect = succeeded,
    *,
    other_noise: bool = False,
) -> Contrast:
    """Return the difference in success, or other ends; `other_noise` as in `Results.pairs`."""
    shown = contrast(results, first, second, effect, other_noise=other_noise)
    return decisive(shown, TELLING_PP)


@quantity
def rate(results: Results, cell: Cell) -> Contrast:
    """Return the success of a cell in percent."""
    pairs = results.pairs(cell, cell)
    return decisive(success_rate(pairs.ended(Status.SUCCESS)[0], results.resamples(pairs)))


@quantity
def time(results: Results, first: Cell, second: Cell) -> Contrast:
    """Return the median difference in time over jointly successful scenes."""
    pairs = results.pairs(first, second)
    one, two = pairs.ended(Status.SUCCESS)
    both = one & two
    if not both.any():
        raise NotRun(f"a scene in which both {first} and {second} succeed")
    return decisive(median_effect(*pairs.time_s, both, results.resamples(pairs)))


@quantity
def combined(results: Results, *terms: tuple[float, Pair], effect: Effect = succeeded) -> Contrast:
    """Return a weighted sum of differences over common scenes, on shared resamples."""
    contrasts = together(results, *(pair for _, pair in terms), effect=effect)
    summed = weighted_sum([weight for weight, _ in terms], contrasts)
    return decisive(summed, TELLING_PP if summed.unit == "pp" else math.inf)


def together(results: Results, *pairs: Pair, effect: Effect = succeeded) -> tuple[Contrast, ...]:
    """Return contrasts over the seeds and the scenes that all of them have, so that they join.

    `NotRun` when there is no such seed or scene.
    """
    joined = joint(results, *pairs)
    return tuple(effect(trials, results.resamples(trials)) for trials in joined)


def joint(results: Results, *pairs: Pair) -> tuple[Pairs, ...]:
    """Return pairs over the seeds and the scenes that all of them have; `NotRun` without any."""
    seeds = results.common_seeds(*(cell for pair in pairs for cell in pair))
    cut = [(_cut(first, seeds), _cut(second, seeds)) for first, second in pairs]
    every = (frozenset(s.index for s in results.pairs(*pair).scenes) for pair in cut)
    kept = frozenset[int].intersection(*every)
    return tuple(results.pairs(*pair, scenes=kept) for pair in cut)


def _cut(cell: Cell, seeds: tuple[int, ...]) -> Cell:
    return cell if cell.fixed else replace(cell, seeds=seeds)


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


@quantity
def greater_effect(results: Results, repair: Repair) -> Contrast:
    """Return the greater of a repair's two effects: with it the repair is behind throughout."""
    tradeoff = crossing(results, repair)
    value = max(tradeoff.correct.value, tradeoff.faulty.value)
    draws = np.maximum(tradeoff.correct.draws, tradeoff.faulty.draws)
    n_scenes = tradeoff.correct.n_scenes
    return decisive(Contrast(value, "pp", n_scenes, draws=draws, against_zero=False))
