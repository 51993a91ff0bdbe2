"""The fault frequency from which on a repair pays (paper, Table V and its footnote).

In a mixture that meets the fault with probability p the expected difference is
``(1 - p) * delta_0 + p * delta_f``.
"""

import numpy as np
from numpy.typing import NDArray

from faultpath.statistics.bootstrap import Effect, check_joint, percentile_interval
from faultpath.statistics.estimate import BreakEven, Direction, DirectionShares
from faultpath.statistics.inputs import Floats

_DIRECTIONS: tuple[Direction, ...] = ("above", "below", "always", "never")


def break_even_point(delta_0: float, delta_f: float) -> tuple[float | None, Direction]:
    """Return (p*, direction) for one pair of effects, under correct inputs and under the fault.

    ``delta_0 < 0 < delta_f``: favoured above ``p* = -delta_0 / (delta_f - delta_0)``.
    ``delta_0 > 0 > delta_f``: favoured below the same expression. Nonnegative at both ends:
    always, with p* = 0. Otherwise (negative somewhere, positive nowhere): never, without p*.
    """
    frequency, kind = _crossings(np.array([delta_0]), np.array([delta_f]))
    direction = _DIRECTIONS[int(kind[0])]
    return (None if direction == "never" else float(frequency[0])), direction


def break_even(correct: Effect, faulty: Effect, level: float = 0.95) -> BreakEven:
    """Return p* with a joint bootstrap interval; both effects must share their resamples.

    Each resample is read in the direction of the estimate. Favoured above p*: a resample that is
    favoured always counts as 0, one favoured never, or only below, as 1. Favoured below p*:
    always counts as 1, and never, or only above, as 0. An estimate of "always" is read as above.
    An estimate of "never" has no interval; its shares say how firm it is.
    """
    check_joint(correct, faulty)
    p_star, direction = break_even_point(correct.value, faulty.value)
    frequency, kind = _crossings(correct.draws, faulty.draws)
    above, below, always, never = (float((kind == k).mean()) for k in range(len(_DIRECTIONS)))
    low = high = None
    if direction != "never":
        favoured_above = direction != "below"
        own, whole, empty = ("above", 0.0, 1.0) if favoured_above else ("below", 1.0, 0.0)
        read = np.where(kind == _DIRECTIONS.index(own), frequency, empty)
        read = np.where(kind == _DIRECTIONS.index("always"), whole, read)
        low, high = percentile_interval(read, level)
    return BreakEven(
        p_star=p_star,
        low=low,
        high=high,
        level=level,
        direction=direction,
        share_without_crossing=always + never,
        shares=DirectionShares(above=above, below=below, always=always, never=never),
        words=_words(p_star, direction, correct.value == faulty.value == 0.0),
        method=f"joint {correct.method}, {correct.resamples.n_resamples} resamples",
        estimand=correct.estimand,
    )


def _crossings(delta_0: Floats, delta_f: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Return p* (0 where there is none) and the index of the direction, elementwise."""
    above = (delta_0 < 0) & (delta_f > 0)
    below = (delta_0 > 0) & (delta_f < 0)
    always = (delta_0 >= 0) & (delta_f >= 0)
    kind = np.select([above, below, always], [0, 1, 2], default=3)
    crosses = above | below
    frequency = np.zeros_like(delta_0, dtype=np.float64)
    np.divide(delta_0, delta_0 - delta_f, out=frequency, where=crosses)
    return frequency, kind.astype(np.intp)


def _words(p_star: float | None, direction: Direction, identical: bool) -> str:
    if p_star is None:
        return "never favoured"
    if direction == "always":
        return "no difference at any fault frequency" if identical else "always favoured"
    return f"favoured {direction} {_percent(p_star)} fault frequency"


def _percent(share: float) -> str:
    if 0.0 < share < 0.005:
        return f"{100.0 * share:.1g} %"
    return f"{100.0 * share:.0f} %"
