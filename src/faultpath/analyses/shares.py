"""At which shares, of faulty episodes or of common causes, a version is ahead."""

import math
from collections.abc import Collection, Mapping, Sequence

from faultpath.analyses.contrasts import PairedTrials
from faultpath.analyses.effects import Effect
from faultpath.analyses.family import TestedContrasts
from faultpath.analyses.model import AS_RUN, CORRECT, SHARED, Ahead, ConditionBreakEven, Share
from faultpath.stats.breakeven import break_even, mixture_curve, only
from faultpath.stats.estimate import Region

_SLACK = 1e-6
"""On a percentage that is a whole number but for rounding."""


def break_even_sets(
    effects: Mapping[str, Effect],
    paired: PairedTrials,
    tested: TestedContrasts,
    untested: Collection[str],
) -> tuple[ConditionBreakEven, ...]:
    """Return where neither version is ahead: over the frequency of the fault under each condition
    in which it acts, and over the beta factor of each module, where the two ends have scenes in
    common."""
    faulted = [name for name in effects if name not in (CORRECT, AS_RUN, *untested)]
    by_frequency = [(CORRECT, name) for name in faulted if CORRECT in effects]
    by_beta = [(name, SHARED) for name in tested.changes]
    shares: Mapping[Share, Sequence[tuple[str, str]]] = {"frequency": by_frequency, "beta": by_beta}
    sets = [
        _between(effects[none], effects[every], paired, tested, over)
        for over, ends in shares.items()
        for none, every in ends
    ]
    return tuple(even for even in sets if even is not None)


def _between(
    none: Effect, every: Effect, paired: PairedTrials, tested: TestedContrasts, over: Share
) -> ConditionBreakEven | None:
    """Return where baseline and repair are even between the effects at two ends of a share, over
    the scenes that both have; `None` where they have none in common.

    The share is that of episodes with the fault of `every`, or the beta factor of the module that
    `none` is of.
    """
    tests = [tested.effects[end.condition].test for end in (none, every)]
    level = 1.0 - min(test.critical_p for test in tests if test and test.critical_p is not None)
    contrasts = tested.design.together(
        paired.success[none.condition], paired.success[every.condition]
    )
    if contrasts is None:
        return None
    bounds = tested.missing.bounds
    filled = [bounds[end.condition] for end in (none, every) if end.condition in bounds]
    # Both ends with what failed trials leave open against the repair, and for it.
    fills = tuple(zip(*filled, strict=True)) if any(a.value != b.value for a, b in filled) else ()
    result = break_even(*contrasts, level=level, fills=fills)
    ahead = [(region, _ahead(region, none, every)) for region in result.regions]
    # A table and a picture leave out what reaches an end whose own effect does not lead.
    shown = [region for region, part in ahead if part and part.where not in ("many", "few")]
    return ConditionBreakEven(
        condition=none.condition if over == "beta" else every.condition,
        over=over,
        result=only(result, shown),
        curve=mixture_curve(*contrasts, level=level, fills=fills),
        ahead=tuple(part for _, part in ahead if part),
    )


def _ahead(region: Region, none: Effect, every: Effect) -> Ahead | None:
    """Return who is significantly ahead at which shares, by one region; `None` where none counts.

    A region counts where it reaches an end (a share of none, or of all) with a significant effect
    on the same side, away from floor and ceiling: so no sentence contradicts that effect.
    """
    sign = region.sign
    low = region.low <= 0.0 and none.leads and sign == none.sign
    high = region.high >= 1.0 and every.leads and sign == every.sign
    if low and high:
        return Ahead(sign=sign, where="everywhere")
    if high and region.low <= 0.0:
        return Ahead(sign=sign, where="many")
    if low and region.high >= 1.0:
        return Ahead(sign=sign, where="few")
    if high and first(region.low) < 100:
        return Ahead(sign=sign, where="from", percent=first(region.low))
    if low and last(region.high) > 0:
        return Ahead(sign=sign, where="up to", percent=last(region.high))
    return None


def first(frequency: float) -> int:
    """Return the first whole percentage at or above a frequency."""
    return math.ceil(100.0 * frequency - _SLACK)


def last(frequency: float) -> int:
    """Return the last whole percentage at or below a frequency."""
    return math.floor(100.0 * frequency + _SLACK)
