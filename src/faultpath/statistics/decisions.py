"""What counts as found: interval and test together, within the family of all that is announced."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from faultpath.statistics import betting, score, signflip, unconditional
from faultpath.statistics.contrast import Contrast
from faultpath.statistics.distributions import sign_p_value, t_p_value
from faultpath.statistics.estimate import (
    ALPHA,
    EM,
    FLIPS,
    SCENES_AND_SEEDS,
    Decision,
    PairedTest,
    RuleName,
    Sign,
)

Turn: TypeAlias = Literal["reversal", "interaction", "none"]


def with_test(contrast: Contrast, rule: RuleName) -> Contrast:
    """Return a contrast with its test: the one place where that is chosen.

    For given models and one seed: exact McNemar, or by the ``unconditional`` rule the E+M test.
    Else, of what scenes differ by: the sign test, or by that rule the larger p of sign flips and of
    the score. For newly trained models: the t test of the seeds' effects. For a sequential audit:
    bets on the mean (`betting`). ``ValueError`` for contrasts that have no test, as means and
    medians of unbounded outcomes.
    """
    if contrast.estimand == SCENES_AND_SEEDS:
        p = t_p_value(np.asarray(contrast.per_seed), contrast.rounding)
        test = PairedTest("t test of the seeds' effects", p, _sign(contrast.value))
        return replace(contrast, test=test)
    scenes, seeds = contrast.scenes, contrast.n_seeds
    if scenes is None or not contrast.against_zero:
        raise ValueError(f"an effect in {contrast.unit} by {contrast.method} has no test")
    first, second = int((scenes.values > 0).sum()), int((scenes.values < 0).sum())
    if scenes.sequential:
        p, leans = betting.p_value(*scenes.kinds(), scenes.bound)
        test = PairedTest("bets on the mean", p, _sign(leans))
    elif rule == "unconditional" and contrast.arms is not None and seeds == 1:
        p = unconditional.p_value(first, second, contrast.n_scenes)
        test = PairedTest(EM, p, _sign(first - second))
    elif rule == "unconditional":
        p = max(signflip.p_value(scenes.values, seeds), score.p_value(*scenes.kinds(), scenes.far))
        test = PairedTest(FLIPS, p, _sign(contrast.value))
    else:
        name = "exact McNemar" if seeds == 1 else "sign test on scene means"
        name = "sign test on scene differences" if contrast.arms is None else name
        test = PairedTest(name, sign_p_value(first, second), _sign(first - second))
    return replace(contrast, test=test)


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
    tests = {name: each.test for name, each in contrasts.items() if each.test is not None}
    p_values = {name: tests[name].p_value for name in contrasts}
    weighs = {name: 1.0 if weights is None else weights[name] for name in contrasts}
    adjusted = holm(p_values, weighs)
    if shares is not None:
        adjusted = {name: min(1.0, p / shares[name]) for name, p in p_values.items()}
    decided: dict[str, Contrast] = {}
    for name, each in contrasts.items():
        leans = tests[name].leans if adjusted[name] <= alpha else 0
        sign = leans if leans and leans == each.side else 0
        critical = alpha * shares[name] if shares else _critical(name, p_values, weighs, alpha)
        decided[name] = replace(each, decision=Decision(sign, adjusted[name], critical))
    return decided


def holm(p_values: Mapping[str, float], weights: Mapping[str, float]) -> dict[str, float]:
    """Return p-values adjusted by Holm's weighted procedure; any positive weights."""
    ordered = sorted(p_values, key=lambda name: p_values[name] / weights[name])
    adjusted: dict[str, float] = {}
    largest = 0.0
    for place, name in enumerate(ordered):
        left = sum(weights[other] for other in ordered[place:])
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


def _critical(
    name: str, p_values: Mapping[str, float], weights: Mapping[str, float], alpha: float
) -> float:
    left = dict(weights)
    others = (other for other in p_values if other != name)
    for other in sorted(others, key=lambda other: p_values[other] / weights[other]):
        if p_values[other] > alpha * weights[other] / sum(left.values()):
            break
        del left[other]
    return alpha * weights[name] / sum(left.values())


def _sign(value: float) -> Sign:
    return 1 if value > 0 else -1 if value < 0 else 0
