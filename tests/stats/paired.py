"""Paired outcomes of two versions with known counts."""

from functools import partial

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
