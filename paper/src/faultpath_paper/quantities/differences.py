"""Quantities of paired trials: differences between cells, and differences of differences."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from faultpath.run import Pairs
from faultpath.stats.contrast import Contrast, weighted_sum
from faultpath.stats.decisions import with_test
from faultpath.stats.effects import mean_effect, median_effect, success_effect, success_rate
from faultpath.stats.resamples import Resamples
from faultpath.system import Status
from faultpath_paper.cells import Cell
from faultpath_paper.results import NotRun, Quantity, Results, decisive

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


def success(
    first: Cell, second: Cell, effect: Effect = succeeded, *, other_noise: bool = False
) -> Quantity:
    """Return the difference in success, or other ends; `other_noise` as in `Results.pairs`."""

    def quantity(results: Results) -> Contrast:
        shown = contrast(results, first, second, effect, other_noise=other_noise)
        return decisive(shown, TELLING_PP)

    return quantity


def rate(cell: Cell) -> Quantity:
    """Return the success of a cell in percent."""

    def quantity(results: Results) -> Contrast:
        pairs = results.pairs(cell, cell)
        return decisive(success_rate(pairs.ended(Status.SUCCESS)[0], results.resamples(pairs)))

    return quantity


def crashes(first: Cell, second: Cell) -> Quantity:
    """Return the difference in crashes."""
    return success(first, second, ended(Status.CRASH))


def timeouts(first: Cell, second: Cell) -> Quantity:
    """Return the difference in timeouts."""
    return success(first, second, ended(Status.TIMEOUT))


def time(first: Cell, second: Cell) -> Quantity:
    """Return the median difference in time over jointly successful scenes."""

    def quantity(results: Results) -> Contrast:
        pairs = results.pairs(first, second)
        one, two = pairs.ended(Status.SUCCESS)
        both = one & two
        if not both.any():
            raise NotRun(f"a scene in which both {first} and {second} succeed")
        return decisive(median_effect(*pairs.time_s, both, results.resamples(pairs)))

    return quantity


def combined(*terms: tuple[float, Pair], effect: Effect = succeeded) -> Quantity:
    """Return a weighted sum of differences over common scenes, on shared resamples."""

    def quantity(results: Results) -> Contrast:
        contrasts = together(results, *(pair for _, pair in terms), effect=effect)
        summed = weighted_sum([weight for weight, _ in terms], contrasts)
        return decisive(summed, TELLING_PP if summed.unit == "pp" else math.inf)

    return quantity


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
