"""Quantities over several cells at once: orderings, shares of scenes, rank correlations."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.stats.contrast import Contrast
from faultpath.stats.effects import success_rate
from faultpath.system import Status
from faultpath_paper.cells import Cell, of_seed
from faultpath_paper.pages import figure_3
from faultpath_paper.quantities.differences import contrast, joint
from faultpath_paper.quantities.windows import Subject, difference_of_quantiles, mean_of_medians
from faultpath_paper.results import NotRun, Results, Undecidable, decisive, quantity

Floats = NDArray[np.float64]


@quantity
def at_lower_success(
    results: Results, first: tuple[Cell, Subject], second: tuple[Cell, Subject], q: float
) -> Contrast:
    """Return a quantile of the error where success is lower (seed 0), minus that at the other.

    `Undecidable` when both succeed equally often.
    """
    (one, error_one), (two, error_two) = first, second
    difference = contrast(results, of_seed(one), of_seed(two)).value
    if difference == 0:
        raise Undecidable("both conditions succeed equally often")
    ordered = (error_one, error_two) if difference < 0 else (error_two, error_one)
    return difference_of_quantiles(*ordered, q)(results)


@quantity
def share(results: Results, cells: Sequence[Cell], end: bool) -> Contrast:
    """Return the share of scenes in which all cells succeed (`end`), or all fail, seed 0."""
    own = [of_seed(cell) for cell in cells]
    every = joint(results, *((cell, cell) for cell in own))
    ends = np.stack([pairs.ended(Status.SUCCESS)[0][:, 0] == end for pairs in every])
    return decisive(success_rate(np.all(ends, axis=0), results.resamples(every[0])))


@quantity
def rank_correlation(results: Results, cells: Sequence[tuple[Cell, Subject]]) -> Contrast:
    """Return Spearman's correlation of success with the median of something measured."""
    rates = [results.rate(cell) for cell, _ in cells]
    measured = np.array([mean_of_medians(results, subject) for _, subject in cells])
    value = spearman(np.array([rate.value for rate in rates]), measured)
    if value is None:
        raise Undecidable("one side is the same in all cells")
    n_scenes = min(rate.n_scenes for rate in rates)
    return Contrast(value, "rank correlation", n_scenes, against_zero=False)


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


PEAK_PERCENT = 90.0


@dataclass(frozen=True)
class _Sweep:
    """Success of some models over the errors of the sweep, on common scenes."""

    errors: list[float]
    rates: list[Floats]
    """Success of each model in percent, `[1 + resamples, errors]`: the estimate, then resamples."""
    n_scenes: int

    def contrast(self, drawn: Floats, unit: str) -> Contrast:
        """Return the contrast of a quantity `[1 + resamples]` of the sweep."""
        value, draws = float(drawn[0]), drawn[1:]
        return decisive(Contrast(value, unit, self.n_scenes, draws=draws, against_zero=False))


@quantity
def worst(results: Results, model: str) -> Contrast:
    """Return the least success of a model over the sweep, in percent."""
    sweep = _sweep(results, model)
    return sweep.contrast(sweep.rates[0].min(axis=1), "percent")


@quantity
def range_gained(results: Results, first: str, second: str) -> Contrast:
    """Return how many more errors of the sweep one model tolerates around 0 than another.

    They are counted outwards from 0, on each side to the first error at which success is below
    `PEAK_PERCENT`.
    """
    sweep = _sweep(results, first, second)
    one, two = (_borne(rates, sweep.errors.index(0.0)) for rates in sweep.rates)
    return sweep.contrast(one - two, "errors")


def _sweep(results: Results, *models: str) -> _Sweep:
    errors = [
        error
        for error in figure_3.ERRORS
        if all(results.has(figure_3.cell(model, error)) for model in models)
    ]
    for error in (figure_3.ERRORS[0], 0.0, figure_3.ERRORS[-1]):
        if error not in errors:
            raise NotRun(f"the sweep of {' and '.join(models)} at e = {error:+g}")
    cells = [figure_3.cell(model, error) for model in models for error in errors]
    every = joint(results, *((cell, cell) for cell in cells))
    effects = [
        success_rate(pairs.ended(Status.SUCCESS)[0], results.resamples(pairs)) for pairs in every
    ]
    columns = np.stack([np.append(effect.value, effect.draws) for effect in effects], axis=1)
    rates = np.split(columns, len(models), axis=1)
    return _Sweep(errors, rates, effects[0].n_scenes)


def _borne(rates: Floats, middle: int) -> Floats:
    high = (rates >= PEAK_PERCENT).astype(np.float64)
    up = np.cumprod(high[:, middle:], axis=1).sum(axis=1)
    down = np.cumprod(high[:, middle::-1], axis=1).sum(axis=1)
    return up + down - high[:, middle]
