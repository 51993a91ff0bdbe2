"""What the test of one seed keeps where there are too many scenes to sum its E step."""

import numpy as np
from scipy.stats import binom

from faultpath.stats import unconditional

SCENES, LEVELS = (2000, 10_000, 100_000), (0.05, 0.0125, 0.001)


def largest_level(scenes: int, alpha: float, shares: int = 1000) -> float:
    """Return the largest chance that equal versions differ at ``alpha``, over the shares of scenes
    that differ: computed from the tables that are significant, without our own sums."""
    fewer = unconditional.critical(scenes, alpha)[1]
    total = np.arange(scenes + 1)
    often = np.asarray(2.0 * binom.cdf(fewer, total, 0.5))
    rare = np.geomspace(0.1, scenes / 2.0, shares // 2) / scenes
    levels = []
    for share in (*rare, *(1.0 - rare), *np.linspace(0.01, 1.0, shares)):
        reach = 9.0 * np.sqrt(scenes * share * (1.0 - share)) + 40.0
        likely = total[np.abs(total - scenes * share) <= reach]
        levels.append(float(binom.pmf(likely, scenes, share) @ often[likely]))
    return max(levels)
