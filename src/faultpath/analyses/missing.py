"""Bounds that trials without an outcome leave: each could have ended either way."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from faultpath.analyses.compared import Outcomes, paired_scenes
from faultpath.analyses.contrasts import Measure
from faultpath.run.pairing import Bools
from faultpath.stats.contrast import Contrast
from faultpath.stats.decisions import with_test
from faultpath.stats.distributions import sign_p_value
from faultpath.stats.estimate import ALPHA, PairedTest

Decide: TypeAlias = Callable[[Mapping[str, Contrast]], dict[str, Contrast]]
"""The joint decision of tested contrasts, by name."""


def filled(success: Outcomes, favour: bool) -> Outcomes:
    """Return outcomes in which all that is missing goes for the repair, or against it."""
    repair, baseline = success
    return np.nan_to_num(repair, nan=float(favour)), np.nan_to_num(baseline, nan=1.0 - favour)


def any_missing(success: Mapping[str, Outcomes]) -> bool:
    """Return whether a trial under any condition has no outcome."""
    return any(np.isnan(part).any() for pair in success.values() for part in pair)


def uneven(success: Outcomes) -> bool:
    """Return whether one version failed more often than chance explains."""
    repair, baseline = map(np.isnan, success)
    alone = int((repair & ~baseline).sum()), int((baseline & ~repair).sum())
    return sign_p_value(*alone) <= ALPHA


def nearest_to_nothing(
    measure: Measure,
    low: Mapping[str, Outcomes],
    high: Mapping[str, Outcomes],
    tested: Sequence[str],
    names: Collection[str],
) -> dict[str, Contrast]:
    """Return the tested contrasts, each as near to no difference as missing outcomes allow, from
    successes with these against the repair and for it."""
    least: dict[str, Contrast] = {}
    lowest = measure.tested(measure.contrasts(low, high, tested))
    highest = measure.tested(measure.contrasts(high, low, tested))
    for name in names:
        one, two = lowest[name], highest[name]
        assert one.test is not None
        assert two.test is not None
        if one.test.leans <= 0:
            nothing = replace(one, test=PairedTest(one.test.name, 1.0, 0))
            one = two if two.test.leans < 0 else nothing
        least[name] = one
    return least


def repairs_needed(
    decided: Mapping[str, Contrast],
    name: str,
    success: Outcomes,
    measure: Measure,
    decide: Decide,
) -> tuple[int, int]:
    """Return how many failed trials of the repair and of the baseline have to run before those that
    are still missing cannot undo an effect, if they come out as the others did: first those of the
    version that alone failed more often, then the others, pair by pair."""
    sign = decided[name].sign
    adverse = filled(success, favour=sign < 0)
    lost = np.stack([np.isnan(part) for part in success])
    alone = lost & ~lost[::-1]
    rank = np.where(alone[alone.sum(axis=(1, 2)).argmax()], 0, np.where(lost.all(axis=0), 1, 2))
    places = sorted(map(tuple, np.argwhere(lost.any(axis=0))), key=lambda place: rank[place])

    def ran(some: int) -> Bools:
        chosen = np.zeros(lost.shape[1:], dtype=np.bool_)
        for place in places[:some]:
            chosen[place] = True
        return chosen

    def holds_with(some: int) -> bool:
        """Return whether the effect holds, evenly, where the first of the failed pairs ran."""
        left = [np.where(ran(some), np.nan, part) for part in adverse]
        still = [np.where(part & ~ran(some), np.nan, 0.0) for part in lost]
        if not paired_scenes(*left).any() or uneven((still[0], still[1])):
            return False
        contrast = with_test(measure.effect(*left))
        return decide({**decided, name: contrast})[name].sign == sign

    low, high = 0, len(places)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds_with(middle) else (middle, high)
    repair, baseline = (int((part & ran(high)).sum()) for part in lost)
    return repair, baseline
