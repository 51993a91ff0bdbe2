"""Trials without an outcome: each could have ended either way."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from faultpath.analyses.contrasts import Design, Outcomes, effect_name, paired_scenes
from faultpath.run.pairing import Bools
from faultpath.stats.contrast import Contrast
from faultpath.stats.decisions import with_test
from faultpath.stats.distributions import sign_p_value, t_p_value
from faultpath.stats.estimate import ALPHA, SCENES_AND_SEEDS, PairedTest

Correct: TypeAlias = Callable[[Mapping[str, Contrast]], dict[str, Contrast]]
"""Corrects the tests of contrasts, by name, for their number."""


def filled(success: Outcomes, favour: bool) -> Outcomes:
    """Return outcomes in which all that is missing goes for the repair, or against it."""
    repair, baseline = success
    return np.nan_to_num(repair, nan=float(favour)), np.nan_to_num(baseline, nan=1.0 - favour)


def failed_unevenly(success: Outcomes) -> bool:
    """Return whether one version failed more often than chance explains."""
    repair, baseline = map(np.isnan, success)
    alone = int((repair & ~baseline).sum()), int((baseline & ~repair).sum())
    return sign_p_value(*alone) <= ALPHA


@dataclass(frozen=True)
class MissingOutcomes:
    """Bounds of contrasts, whichever way trials without an outcome would have ended."""

    bounds: Mapping[str, tuple[Contrast, Contrast]] = field(
        default_factory=dict[str, tuple[Contrast, Contrast]]
    )
    """By condition, where any trial is missing: the effect with all missing ones against the
    repair, and for it."""
    inconclusive: tuple[str, ...] = ()
    """Contrasts, by name, that would be significant but for those trials."""
    reruns: Mapping[str, tuple[int, int]] = field(default_factory=dict[str, tuple[int, int]])
    """By condition whose effect is one of these: how many failed trials of the repair and of the
    baseline have to run to make it significant, if they come out as the others did."""


def missing_outcomes(
    design: Design,
    tested: Sequence[str],
    success: Mapping[str, Outcomes],
    corrected: Mapping[str, Contrast],
    correct: Correct,
) -> MissingOutcomes:
    """Return the bounds that missing trials leave of contrasts, `corrected` without them."""
    if not any(np.isnan(part).any() for pair in success.values() for part in pair):
        return MissingOutcomes()
    low = {condition: filled(pair, favour=False) for condition, pair in success.items()}
    high = {condition: filled(pair, favour=True) for condition, pair in success.items()}
    nearest = nearest_to_nothing(
        design.contrasts(tested, low, alone=high), design.contrasts(tested, high, alone=low)
    )
    worst_case = correct({name: nearest[name] for name in corrected})
    inconclusive = [
        name
        for name, contrast in corrected.items()
        if contrast.sign not in (0, worst_case[name].sign)
    ]
    return MissingOutcomes(
        bounds={
            condition: (design.effect(*low[condition]), design.effect(*high[condition]))
            for condition in success
        },
        inconclusive=tuple(inconclusive),
        reruns={
            condition: reruns_needed(
                corrected, effect_name(condition), success[condition], design, correct
            )
            for condition in tested
            if effect_name(condition) in inconclusive
        },
    )


def nearest_to_nothing(
    lowest: Mapping[str, Contrast], highest: Mapping[str, Contrast]
) -> dict[str, Contrast]:
    """Return contrasts as near to no difference as missing outcomes allow: with all of them against
    the repair where it is ahead even so, with all for it where the baseline is, else none.

    For newly trained models with the p of trainings that they part the most.
    """
    nearest: dict[str, Contrast] = {}
    for name, low in lowest.items():
        high = highest[name]
        assert low.test is not None
        assert high.test is not None
        if low.test.leans > 0:
            nearest[name] = low
        elif high.test.leans < 0:
            nearest[name] = high
        else:  # no difference is possible
            nearest[name] = replace(low, test=PairedTest(low.test.name, 1.0, 0))
        if low.estimand == SCENES_AND_SEEDS:
            nearest[name] = _trainings_apart(nearest[name], low, high)
    return nearest


def _trainings_apart(nearest: Contrast, low: Contrast, high: Contrast) -> Contrast:
    """Return a contrast with the p-value of trainings that missing outcomes part the most: of those
    with the larger effects they go for the repair, of the others against it, from one split on."""
    assert nearest.test is not None
    against, favour = np.array(low.per_seed), np.array(high.per_seed)
    order = np.argsort(against + favour)
    splits = (np.where(order.argsort() < n, against, favour) for n in range(len(order) + 1))
    p_value = max(t_p_value(effects, nearest.rounding) for effects in splits)
    test = nearest.test._replace(p_value=max(p_value, nearest.test.p_value))
    return replace(nearest, test=test)


def reruns_needed(
    corrected: Mapping[str, Contrast],
    name: str,
    success: Outcomes,
    design: Design,
    correct: Correct,
) -> tuple[int, int]:
    """Return how many failed trials of the repair and of the baseline have to run before those that
    are still missing cannot undo an effect, if they come out as the others did: first those of the
    version that alone failed more often, then the others, pair by pair, and of these first those
    that could cost the most."""
    sign = corrected[name].sign
    fills = [filled(success, favour) for favour in (False, True)]
    missing = np.stack([np.isnan(part) for part in success])
    one_alone = missing & ~missing[::-1]
    often = one_alone.sum(axis=(1, 2))
    more_often = one_alone[often == often.max()].any(axis=0)
    rank = np.where(more_often, 0, np.where(missing.all(axis=0), 1, 2))
    worst = sign * np.subtract(*fills[sign < 0])
    scenes, seeds = np.nonzero(missing.any(axis=0))
    order = np.lexsort((worst[scenes, seeds], rank[scenes, seeds]))

    def rerun(count: int) -> Bools:
        """Return `[scenes, seeds]` whether a pair is among the first `count`."""
        chosen = np.zeros(missing.shape[1:], dtype=np.bool_)
        chosen[scenes[order[:count]], seeds[order[:count]]] = True
        return chosen

    def holds_with(count: int) -> bool:
        """Return whether the effect is significant, and failures even, where these pairs ran."""
        low, high = ([np.where(rerun(count), np.nan, part) for part in fill] for fill in fills)
        still = [np.where(part & ~rerun(count), np.nan, 0.0) for part in missing]
        if not paired_scenes(*low).any() or failed_unevenly((still[0], still[1])):
            return False
        ends = ({name: with_test(design.effect(*left))} for left in (low, high))
        return correct({**corrected, **nearest_to_nothing(*ends)})[name].sign == sign

    # Bisection, since each further pair that ran leaves less to be set against the effect.
    low, high = 0, len(order)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds_with(middle) else (middle, high)
    repair, baseline = (int((part & rerun(high)).sum()) for part in missing)
    return repair, baseline
