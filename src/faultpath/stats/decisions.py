"""Rules of detection: interval and test together, within the family of all that is announced."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from faultpath.stats import betting, score, unconditional
from faultpath.stats.contrast import Contrast, ordered_sum
from faultpath.stats.distributions import sign_p_value, t_p_value
from faultpath.stats.estimate import (
    ALPHA,
    DEGREES,
    EM,
    SCENES_AND_SEEDS,
    PairedTest,
)

Turn: TypeAlias = Literal["reversal", "interaction", "none"]


def with_test(contrast: Contrast) -> Contrast:
    """Return a contrast with its test: the one place where that is chosen.

    For given models and one seed: the E+M test, or where its scenes are not graded McNemar's. Else,
    of what scenes differ by: the test of degrees (`score`), or the sign test. For newly trained
    models: the t test of the seeds' effects. For a sequential audit: bets on the mean.
    ``ValueError`` for contrasts that have no test, as those of unbounded outcomes.
    """
    scenes, seeds, ahead = contrast.scenes, contrast.n_seeds, contrast.value
    one_seed = contrast.pairs is not None and seeds == 1
    first, second = contrast.ahead
    if contrast.estimand == SCENES_AND_SEEDS:
        name = "t test of the seeds' effects"
        p = t_p_value(np.asarray(contrast.per_seed), contrast.rounding)
    elif scenes is None or not contrast.against_zero:
        raise ValueError(f"an effect in {contrast.unit} by {contrast.method} has no test")
    elif scenes.sequential:
        name = "bets on the mean"
        p, ahead = betting.p_value(*scenes.kinds(), scenes.bound)
    elif scenes.graded and one_seed:
        name = EM + unconditional.approximation(contrast.n_scenes)
        p, ahead = unconditional.p_value(first, second, contrast.n_scenes), first - second
    elif scenes.graded:
        name = DEGREES + unconditional.approximation(contrast.n_scenes)
        p = score.degrees_p_value(*scenes.kinds(), scenes.bound)
    else:
        name = "exact McNemar" if one_seed else "sign test on scene means"
        name = "sign test on scene differences" if contrast.pairs is None else name
        p, ahead = sign_p_value(first, second), first - second
    leans = 1 if ahead > 0 else -1 if ahead < 0 else 0
    return replace(contrast, test=PairedTest(name, p, leans))


def decide_family(
    contrasts: Mapping[str, Contrast],
    alpha: float = ALPHA,
    shares: Mapping[str, float] | None = None,
    weights: Mapping[str, float] | None = None,
) -> dict[str, Contrast]:
    """Decide tested contrasts together: Holm's adjustment of all p-values given.

    With ``weights`` (any positive numbers) it is his weighted one: each has that part of ``alpha``,
    and what is detected leaves its part to the others.

    One is detected when its adjusted p-value is at most ``alpha``, its interval excludes 0 and both
    point the same way. So one or more false detections among all of them come in at most a share
    ``alpha`` of audits, whichever of the nulls are true. With ``shares`` (of ``alpha``, at most 1
    together) each contrast stands by itself at its own share of it, Bonferroni's procedure.
    """
    tests = {name: contrast.test for name, contrast in contrasts.items() if contrast.test}
    p_values = {name: tests[name].p_value for name in contrasts}
    weighs = {name: 1.0 if weights is None else weights[name] for name in contrasts}
    adjusted = holm(p_values, weighs)
    if shares is not None:
        adjusted = {name: min(1.0, p / shares[name]) for name, p in p_values.items()}
    ordered = sorted(p_values, key=lambda name: p_values[name] / weighs[name])
    decided: dict[str, Contrast] = {}
    for name, contrast in contrasts.items():
        leans = tests[name].leans if adjusted[name] <= alpha else 0
        sign = leans if leans and leans == contrast.sign_of_interval else 0
        if shares:
            critical = alpha * shares[name]
        else:
            left = dict(weighs)
            for other in ordered:
                if other == name:
                    continue
                if p_values[other] > alpha * weighs[other] / ordered_sum(left.values()):
                    break
                del left[other]
            critical = alpha * weighs[name] / ordered_sum(left.values())
        test = tests[name]._replace(sign=sign, corrected_p=adjusted[name], critical_p=critical)
        decided[name] = replace(contrast, test=test)
    return decided


def holm(p_values: Mapping[str, float], weights: Mapping[str, float]) -> dict[str, float]:
    """Return p-values adjusted by Holm's weighted procedure; any positive weights."""
    ordered = sorted(p_values, key=lambda name: p_values[name] / weights[name])
    adjusted: dict[str, float] = {}
    largest = 0.0
    for place, name in enumerate(ordered):
        left = ordered_sum(weights[other] for other in ordered[place:])
        largest = max(largest, min(1.0, left / weights[name] * p_values[name]))
        adjusted[name] = largest
    return adjusted


def turn(isolated: Contrast, shared: Contrast, change: Contrast) -> Turn:
    """Say what sharing a fault does to an effect, from three contrasts that one family decided.

    A reversal is two effects detected on opposite sides of 0: an intersection-union test, so the
    change between them needs no further test. An interaction is a detected change without that.
    """
    if isolated.sign * shared.sign < 0:
        return "reversal"
    return "interaction" if change.sign else "none"
