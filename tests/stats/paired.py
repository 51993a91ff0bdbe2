"""Paired outcomes of two versions with known counts, and Holm's procedure by its definition."""

from collections.abc import Sequence
from functools import partial
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from faultpath.stats.effects import success_effect

conditional_effect = partial(success_effect, test="conditional")
"""The paper's effect."""

Bools = NDArray[np.bool_]


def counted(wins: int, losses: int, n: int = 100, start: int = 0) -> tuple[Bools, Bools]:
    """Return success of two versions in `n` scenes, of which each wins some alone, from a scene
    on."""
    scene = (np.arange(n) - start) % n
    return scene < wins, (scene >= wins) & (scene < wins + losses)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return the p-values that Holm's procedure adjusts."""
    order = np.argsort(p_values)
    left = range(len(order), 0, -1)
    steps = (min(1.0, count * p_values[place]) for count, place in zip(left, order, strict=True))
    adjusted = dict(zip(order.tolist(), accumulate(steps, max), strict=True))
    return [adjusted[place] for place in range(len(order))]
