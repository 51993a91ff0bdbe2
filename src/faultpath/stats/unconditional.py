"""Lloyd's E+M test of no difference between paired binary outcomes (Biometrics 64:716, 2008).

Exact McNemar conditions on the number of discordant pairs, and with few of them no split is rare.
This test does not. *E*: the probability of a ``|first - second| / sqrt(discordant)`` at least as
large, at the observed share of discordant pairs. *M*: this probability only orders the tables; the
p-value is the largest probability, over all shares of discordant pairs, of a table that is at least
as extreme. So the level holds whatever the share.

Tables are named by their discordant pairs and the smaller of both counts, the *fewer*.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from faultpath.stats.inputs import Floats
from faultpath.stats.many_pairs import ManyPairs
from faultpath.stats.null_law import TIE, Counts, NullLaw, bounds

Bools = NDArray[np.bool_]

MOST_SUMMED = 1000
"""Largest number of pairs for which E is summed for every table; beyond, see `many_pairs`."""


@lru_cache(maxsize=4096)
def p_value(first: int, second: int, n_pairs: int) -> float:
    """Return the two-sided p of ``first`` against ``second`` discordant pairs among ``n_pairs``."""
    if first == second:
        return 1.0
    return degrees_p_value(abs(first - second) / np.sqrt(first + second), first + second, n_pairs)


def degrees_p_value(z: float, discordants: float, n_pairs: int) -> float:
    """Return the two-sided p of ``z``, for a number of discordant pairs that need not be whole."""
    law = _law(n_pairs)
    chance = law.chance(np.array([z]), np.array([discordants]))[0]
    return law.worst(law.region(float(chance), *bounds(n_pairs))) if z else 1.0


def approximation(n_pairs: int) -> str:
    """Return the suffix of the test's name that tells an approximate E step."""
    return "" if n_pairs <= MOST_SUMMED else ", normal E"


def degrees_rejects(z: Floats, discordants: Floats, n_pairs: int, alpha: float) -> Bools:
    """Return [tables]: whether that p is at most ``alpha``."""
    chances = _law(n_pairs).chance(z, discordants)
    return (z > 0.0) & (chances <= critical(n_pairs, alpha)[0] * (1.0 + TIE))


def critical(n_pairs: int, alpha: float) -> tuple[float, Counts]:
    """Return the E step's largest probability with a p of at most ``alpha``, and [discordants] the
    largest smaller count within it; -1: none."""
    return _critical(n_pairs, round(alpha, 15))  # 1 - 0.95 is 0.05


@lru_cache(maxsize=256)
def _critical(n_pairs: int, alpha: float) -> tuple[float, Counts]:
    return _law(n_pairs).critical(alpha)


@lru_cache(maxsize=4)
def _law(n_pairs: int) -> NullLaw | ManyPairs:
    return NullLaw(n_pairs) if n_pairs <= MOST_SUMMED else ManyPairs(n_pairs)
