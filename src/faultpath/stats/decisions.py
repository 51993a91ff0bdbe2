"""Which effects are significant: test and interval together, corrected within a family."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, TypeAlias, TypeVar

import numpy as np

from faultpath.stats import betting, score, unconditional
from faultpath.stats.contrast import Contrast, ordered_sum
from faultpath.stats.distributions import sign_p_value, t_p_value
from faultpath.stats.estimate import (
    ALPHA,
    DEGREES,
    EM,
    SCENES_AND_SEEDS,
    TRAININGS,
    PairedTest,
    sign_of,
)

Name = TypeVar("Name", str, int, tuple[int, int])
Turn: TypeAlias = Literal["reversal", "interaction", "none"]


def with_test(contrast: Contrast) -> Contrast:
    """Return a contrast with its test, which only this function chooses.

    One seed of given models: the E+M test, or McNemar's if ``test`` of its scenes is conditional.
    Several seeds: the test of degrees (`score`), or the sign test. Newly trained models: the larger
    p of the test of degrees and of the t test of the seeds' effects, which takes the scenes for
    known. A sequential audit: bets on the mean. ``ValueError`` for contrasts that have no test,
    such as those of unbounded outcomes.
    """
    scenes, seeds, ahead = contrast.scenes, contrast.n_seeds, contrast.value
    one_seed = contrast.pairs is not None and seeds == 1
    first, second = contrast.ahead
    if scenes is None or not contrast.against_zero:
        raise ValueError(f"an effect in {contrast.unit} by {contrast.method} has no test")
    if contrast.estimand == SCENES_AND_SEEDS:
        name = TRAININGS + unconditional.approximation(contrast.n_scenes)
        by_seed = t_p_value(np.asarray(contrast.per_seed), contrast.rounding)
        p = max(by_seed, score.degrees_p_value(*scenes.kinds, scenes.bound))
    elif scenes.test == "sequential":
        name = "bets on the mean"
        p, ahead = betting.p_value(*scenes.kinds, scenes.bound)
    elif scenes.test == "unconditional" and one_seed:
        name = EM + unconditional.approximation(contrast.n_scenes)
        p, ahead = unconditional.p_value(first, second, contrast.n_scenes), first - second
    elif scenes.test == "unconditional":
        name = DEGREES + unconditional.approximation(contrast.n_scenes)
        p = score.degrees_p_value(*scenes.kinds, scenes.bound)
    else:
        name = "exact McNemar" if one_seed else "sign test on scene means"
        name = "sign test on scene differences" if contrast.pairs is None else name
        p, ahead = sign_p_value(first, second), first - second
    return replace(contrast, test=PairedTest(name, p, sign_of(ahead)))


def decide_family(
    contrasts: Mapping[str, Contrast],
    alpha: float = ALPHA,
    shares: Mapping[str, float] | None = None,
    weights: Mapping[str, float] | None = None,
) -> dict[str, Contrast]:
    """Return tested contrasts with p-values corrected together, by Holm's procedure.

    With ``weights`` (any positive numbers) it is his weighted one: each contrast has that part of
    ``alpha``, and a significant one leaves its part to the others.

    A contrast is significant when its corrected p-value is at most ``alpha``, its interval excludes
    0 and both point the same way. So at most a share ``alpha`` of audits have one or more false
    findings, whichever of the nulls are true. With ``shares`` (of ``alpha``, at most 1 together)
    each contrast has its own share of it by itself, which is Bonferroni's procedure.
    """
    tests = {name: contrast.test for name, contrast in contrasts.items() if contrast.test}
    p_values = {name: test.p_value for name, test in tests.items()}
    if shares is not None:
        adjusted = {name: min(1.0, p / shares[name]) for name, p in p_values.items()}
        critical = {name: alpha * shares[name] for name in p_values}
    else:
        weight = {name: weights[name] if weights else 1.0 for name in p_values}
        adjusted = holm(p_values, weight)
        critical = {name: _critical_p(name, p_values, weight, alpha) for name in p_values}
    corrected: dict[str, Contrast] = {}
    for name, contrast in contrasts.items():
        leans = tests[name].leans if adjusted[name] <= alpha else 0
        # An interval takes long: it is not computed where the test does not reject.
        sign = leans if leans and leans == contrast.sign_of_interval else 0
        test = tests[name]._replace(
            sign=sign, corrected_p=adjusted[name], critical_p=critical[name]
        )
        corrected[name] = replace(contrast, test=test)
    return corrected


def _critical_p(
    name: str, p_values: Mapping[str, float], weights: Mapping[str, float], alpha: float
) -> float:
    """Return the largest p with which Holm's procedure rejects, given the others' p-values."""
    remaining = dict(weights)
    for other in sorted(p_values, key=lambda name: p_values[name] / weights[name]):
        if other == name:
            continue
        if p_values[other] > alpha * weights[other] / ordered_sum(remaining.values()):
            break
        del remaining[other]
    return alpha * weights[name] / ordered_sum(remaining.values())


def holm(
    p_values: Mapping[Name, float], weights: Mapping[Name, float] | None = None
) -> dict[Name, float]:
    """Return p-values adjusted by Holm's procedure, or his weighted one; any positive weights."""
    weights = dict.fromkeys(p_values, 1.0) if weights is None else weights
    ordered = sorted(p_values, key=lambda name: p_values[name] / weights[name])
    adjusted: dict[Name, float] = {}
    largest = 0.0
    for index, name in enumerate(ordered):
        remaining = ordered_sum(weights[other] for other in ordered[index:])
        largest = max(largest, min(1.0, remaining / weights[name] * p_values[name]))
        adjusted[name] = largest
    return adjusted


def turn(isolated: Contrast, shared: Contrast, change: Contrast) -> Turn:
    """Return what sharing a fault does to an effect, from three contrasts of one family.

    A reversal is two significant effects on opposite sides of 0: an intersection-union test, so
    the change between them needs no further test. An interaction is a significant change without a
    reversal.
    """
    if isolated.sign * shared.sign < 0:
        return "reversal"
    return "interaction" if change.sign else "none"
