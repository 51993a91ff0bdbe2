"""Lloyd's E+M test of no difference between paired binary outcomes (Biometrics 64:716, 2008).

Exact McNemar holds the number of discordant pairs fixed, and among few of them no split is rare.
This test leaves it free. *E*: the chance of a ``|first - second| / sqrt(discordant)`` at least as
large, where pairs are discordant as often as was seen. *M*: that chance only orders the tables;
the p-value is the largest chance, over all shares of discordant pairs, of a table that is ordered
as far out. So the level holds whatever the share.

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
"""Pairs up to which E is summed for every table; of more see `many_pairs`."""


@lru_cache(maxsize=4096)
def p_value(first: int, second: int, n_pairs: int) -> float:
    """Return the two-sided p of ``first`` against ``second`` discordant pairs among ``n_pairs``."""
    if first == second:
        return 1.0
    return degrees_p_value(abs(first - second) / np.sqrt(first + second), first + second, n_pairs)


def degrees_p_value(z: float, discordants: float, n_pairs: int) -> float:
    """Return the two-sided p of ``z`` where the number of discordant pairs need not be whole."""
    law = _law(n_pairs)
    seen = law.chance(np.array([z]), np.array([discordants]))[0]
    return law.worst(law.region(float(seen), *bounds(n_pairs))) if z else 1.0


def approximation(n_pairs: int) -> str:
    """Return what the name of the test says of its E step."""
    return "" if n_pairs <= MOST_SUMMED else ", normal E"


def degrees_rejects(z: Floats, discordants: Floats, n_pairs: int, alpha: float) -> Bools:
    """Return [tables]: whether that p is at most ``alpha``."""
    seen = _law(n_pairs).chance(z, discordants)
    return (z > 0.0) & (seen <= critical(n_pairs, alpha)[0] * (1.0 + TIE))


def critical(n_pairs: int, alpha: float) -> tuple[float, Counts]:
    """Return the E step's largest chance with a p of at most ``alpha``, and [discordants] the
    largest smaller count within it; -1: none."""
    return _critical(n_pairs, round(alpha, 15))  # 1 - 0.95 is 0.05


@lru_cache(maxsize=256)
def _critical(n_pairs: int, alpha: float) -> tuple[float, Counts]:
    return _law(n_pairs).critical(alpha)


@lru_cache(maxsize=4)
def _law(n_pairs: int) -> NullLaw | ManyPairs:
    return NullLaw(n_pairs) if n_pairs <= MOST_SUMMED else ManyPairs(n_pairs)
