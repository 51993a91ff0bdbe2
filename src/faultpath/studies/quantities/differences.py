"""Quantities of paired trials: differences between cells, and differences of differences."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics import Contrast as Difference
from faultpath.statistics import Resamples, median_effect, success_effect, weighted_sum, with_test
from faultpath.studies.cells import Cell
from faultpath.studies.quantities.found import MIN_SCENES, Found, Quantity, of_effect
from faultpath.studies.results import Contrast, NotRun, Results
from faultpath.trials.pairing import Trials

Pair: TypeAlias = tuple[Cell, Cell]
Bools: TypeAlias = NDArray[np.bool_]

TELLING_PP = 20.0
"""A difference in success that a run must be able to detect for its absence to say anything."""


def success(first: Cell, second: Cell, *, other_noise: bool = False) -> Quantity:
    """Return the difference in success; `other_noise` as in `Results.contrast`."""
    return _outcomes(first, second, lambda trials: trials.success, other_noise)


def crashes(first: Cell, second: Cell) -> Quantity:
    """Return the difference in crashes."""
    return _outcomes(first, second, lambda trials: trials.crash)


def timeouts(first: Cell, second: Cell) -> Quantity:
    """Return the difference in timeouts."""
    return _outcomes(first, second, lambda trials: ~(trials.success | trials.crash))


def time(first: Cell, second: Cell) -> Quantity:
    """Return the median difference in time over jointly successful scenes."""

    def found(results: Results) -> Found:
        contrast = results.contrast(first, second)
        one, two = contrast.pairs.first, contrast.pairs.second
        both = one.success & two.success
        if not both.any():
            raise NotRun(
                f"a scene in which both {results.named(first)} and {results.named(second)} succeed"
            )
        return of_effect(median_effect(one.time_s, two.time_s, both, contrast.resamples))

    return found


def success_draws(contrast: Contrast) -> Difference:
    """Return the difference in success with its draws."""
    return contrast.draws


def combined(
    *terms: tuple[float, Pair], effect: Callable[[Contrast], Difference] = success_draws
) -> Quantity:
    """Return a weighted sum of differences over common scenes, on shared resamples."""

    def found(results: Results) -> Found:
        contrasts = together(results, *(pair for _, pair in terms))
        weights = [weight for weight, _ in terms]
        return of_effect(weighted_sum(weights, [effect(contrast) for contrast in contrasts]))

    return found


def together(results: Results, *pairs: Pair) -> tuple[Contrast, ...]:
    """Return contrasts over the seeds and the scenes that all of them have, so that they join.

    `NotRun` when there is no such seed or scene.
    """
    seeds = _common([results.seeds(cell) for pair in pairs for cell in pair])
    if not seeds:
        raise NotRun(f"a seed that {results.named(pairs[0][0])} and all it is compared with share")
    return _joint(results, *((replace(a, seeds=seeds), replace(b, seeds=seeds)) for a, b in pairs))


def _joint(results: Results, *pairs: Pair) -> tuple[Contrast, ...]:
    """Return contrasts over the scenes that all of them have, so that they resample together."""
    found = [results.contrast(first, second) for first, second in pairs]
    kept = set(found[0].pairs.scene_indices)
    for contrast in found:
        kept &= set(contrast.pairs.scene_indices)
    return tuple(results.contrast(*pair, scenes=sorted(kept)) for pair in pairs)


def compared(first: Bools, second: Bools, resamples: Resamples) -> Found:
    """Return the difference of two binary arms [scenes, seeds] with the paper's test."""
    effect = with_test(success_effect(first, second, resamples))
    return Found(
        value=effect.value,
        interval=effect.interval if effect.n_scenes >= MIN_SCENES else None,
        unit=effect.unit,
        n_scenes=effect.n_scenes,
        test=effect.test,
        mde=effect.least,
        telling_mde=TELLING_PP,
        counts=str(effect.counts),
    )


def _outcomes(
    first: Cell, second: Cell, ended: Callable[[Trials], Bools], other_noise: bool = False
) -> Quantity:
    def found(results: Results) -> Found:
        contrast = results.contrast(first, second, other_noise=other_noise)
        pairs = contrast.pairs
        return compared(ended(pairs.first), ended(pairs.second), contrast.resamples)

    return found


def _common(seeds: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
    first, *others = seeds
    return tuple(seed for seed in first if all(seed in other for other in others))
