"""Quantities of the free-space sweep over calibration errors (paper, Figure 3)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics import Contrast, success_rate
from faultpath_quadrotor.paper.pages import figure_3
from faultpath_quadrotor.paper.quantities.differences import joint
from faultpath_quadrotor.paper.results import NotRun, Quantity, Results, decisive

Floats = NDArray[np.float64]

PEAK_PERCENT = 90.0


@dataclass(frozen=True)
class _Sweep:
    """What some models flew, over common scenes."""

    errors: list[float]
    rates: list[Floats]
    """Of each model `[1 + resamples, errors]`: success in percent, and in every resample."""
    n_scenes: int

    def found(self, drawn: Floats, unit: str) -> Contrast:
        """Return a quantity `[1 + resamples]` of the sweep."""
        value, draws = float(drawn[0]), drawn[1:]
        return decisive(Contrast(value, unit, self.n_scenes, draws=draws, against_zero=False))


def worst_difference(first: str, second: str) -> Quantity:
    """Return the least success of one model over the sweep, minus that of another."""

    def found(results: Results) -> Contrast:
        sweep = _sweep(results, first, second)
        one, two = (rates.min(axis=1) for rates in sweep.rates)
        return sweep.found(one - two, "pp")

    return found


def above_worst(model: str, error: float) -> Quantity:
    """Return the success of a model at an error, minus its least over the sweep."""

    def found(results: Results) -> Contrast:
        sweep = _sweep(results, model)
        (rates,) = sweep.rates
        return sweep.found(rates[:, sweep.errors.index(error)] - rates.min(axis=1), "pp")

    return found


def range_gained(first: str, second: str) -> Quantity:
    """Return how many more errors of the sweep one model bears around 0 than another.

    They are counted outwards from 0, on each side to the first error at which success is below
    `PEAK_PERCENT`.
    """

    def found(results: Results) -> Contrast:
        sweep = _sweep(results, first, second)
        one, two = (_borne(rates, sweep.errors.index(0.0)) for rates in sweep.rates)
        return sweep.found(one - two, "errors")

    return found


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
    effects = [success_rate(pairs.first.success, results.resamples(pairs)) for pairs in every]
    columns = np.stack([np.append(effect.value, effect.draws) for effect in effects], axis=1)
    rates = np.split(columns, len(models), axis=1)
    return _Sweep(errors, rates, effects[0].n_scenes)


def _borne(rates: Floats, middle: int) -> Floats:
    held = (rates >= PEAK_PERCENT).astype(np.float64)
    up = np.cumprod(held[:, middle:], axis=1).sum(axis=1)
    down = np.cumprod(held[:, middle::-1], axis=1).sum(axis=1)
    return up + down - held[:, middle]
