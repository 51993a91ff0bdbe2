"""Quantities over several cells at once: orderings, shares of scenes, rank correlations."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics import Contrast, success_rate
from faultpath_quadrotor.paper.cells import Cell, of_seed
from faultpath_quadrotor.paper.quantities.differences import contrast, joint
from faultpath_quadrotor.paper.quantities.windows import (
    Subject,
    difference_of_quantiles,
    mean_of_medians,
)
from faultpath_quadrotor.paper.results import Quantity, Results, Undecidable, decisive

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


def at_lower_success(
    first: tuple[Cell, Subject], second: tuple[Cell, Subject], q: float
) -> Quantity:
    """Return a quantile of the error where success is lower (seed 0), minus that at the other.

    `Undecidable` when both succeed equally often.
    """

    def found(results: Results) -> Contrast:
        (one, error_one), (two, error_two) = first, second
        difference = contrast(results, of_seed(one), of_seed(two)).value
        if difference == 0:
            raise Undecidable("both conditions succeed equally often")
        ordered = (error_one, error_two) if difference < 0 else (error_two, error_one)
        return difference_of_quantiles(*ordered, q)(results)

    return found


def share(cells: Sequence[Cell], of: Callable[[Bools], Bools]) -> Quantity:
    """Return the share of scenes that `of` finds in `[cells, scenes]` successes of seed 0."""

    def found(results: Results) -> Contrast:
        own = [of_seed(cell) for cell in cells]
        every = joint(results, *((cell, cell) for cell in own))
        success = np.stack([pairs.first.success[:, 0] for pairs in every])
        return decisive(success_rate(of(success), results.resamples(every[0])))

    return found


def in_all(success: Bools) -> Bools:
    """Return the scenes that succeed in every cell."""
    return np.all(success, axis=0)


def in_none(success: Bools) -> Bools:
    """Return the scenes that succeed in no cell."""
    return ~np.any(success, axis=0)


def rank_correlation(cells: Sequence[tuple[Cell, Subject]]) -> Quantity:
    """Return Spearman's correlation of success with the median of something measured."""

    def found(results: Results) -> Contrast:
        rates = [results.rate(cell) for cell, _ in cells]
        measured = np.array([mean_of_medians(results, subject) for _, subject in cells])
        value = spearman(np.array([rate.value for rate in rates]), measured)
        if value is None:
            raise Undecidable("one side is the same in all cells")
        n_scenes = min(rate.n_scenes for rate in rates)
        return Contrast(value, "rank correlation", n_scenes, against_zero=False)

    return found


def spearman(one: Floats, two: Floats) -> float | None:
    """Return Spearman's rank correlation of two [n] arrays; None where one side is constant.

    It has no p-value: cells are not a sample.
    """
    if np.ptp(one) == 0.0 or np.ptp(two) == 0.0:
        return None
    value = float(np.corrcoef(_ranks(one), _ranks(two))[0, 1])
    return min(1.0, max(-1.0, value))


def _ranks(values: Floats) -> Floats:
    _, place, times = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(times) - (times - 1) / 2.0)[place]
