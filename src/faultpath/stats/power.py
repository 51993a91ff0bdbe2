"""Power of the rule that decides, test and score interval, and the least difference it detects.

That difference stands beside every "not detected", because not detecting one is not equivalence.
There is none for newly trained models: a few trainings do not know their own spread.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from faultpath.core.streams import generator
from faultpath.stats import unconditional
from faultpath.stats.distributions import binomial_cdf, binomial_pmf, likely
from faultpath.stats.estimate import ALPHA
from faultpath.stats.inputs import Floats, Numbers, by_scene_and_seed
from faultpath.stats.score import degrees_rejects, quantile, reach, rejects

LEVEL = 0.95
"""Level of the interval that has to exclude 0 as well."""
AUDITS = 2000
"""Simulated audits, where power has no closed form."""
_PRECISION = 1e-3
_MISSING = 2.0
"""Stands for a pair without both outcomes, where columns of pairs are compared."""
_PRIOR_ALIKE, _PRIOR_SCENES = 0.5, 1.0
"""Counts of seeds that end alike, taken as seen before anything was."""


def fewest_scenes(alpha: float = ALPHA) -> int:
    """Return how many scenes a test at ``alpha`` needs at least to detect anything at all.

    If all favour one variant, sign test and E+M test have the same p, ``2 ** (1 - scenes)``.
    """
    return int(np.ceil(1.0 + np.log2(1.0 / alpha) - 1e-12))


def rule_power(
    n_scenes: int,
    discordant_rate: float,
    difference: float,
    alpha: float = ALPHA,
    *,
    graded: bool = False,
) -> float:
    """Return the exact power of one seed's test at ``alpha`` together with Tango's 95 % interval.

    Each of ``n_scenes`` pairs is discordant with probability ``discordant_rate`` and the success
    probabilities differ by ``difference`` (fractions, |difference| <= discordant_rate). The number
    of discordant pairs is enumerated, and the binomial of their split is summed in closed form.
    """
    if n_scenes < 1 or not 0.0 <= abs(difference) <= discordant_rate <= 1.0:
        raise ValueError(
            f"need 0 <= |difference| <= discordant_rate <= 1 and scenes, got "
            f"{difference}, {discordant_rate} and {n_scenes}"
        )
    if discordant_rate == 0.0:
        return 0.0
    first, last = likely(n_scenes, discordant_rate, discordant_rate)
    discordants = np.arange(first, last + 1)
    critical = _critical(n_scenes, alpha, graded)[discordants]
    favour = 0.5 * (1.0 + abs(difference) / discordant_rate)
    detects = binomial_cdf(critical, discordants, favour)
    detects = detects + binomial_cdf(critical, discordants, 1.0 - favour)
    return float(binomial_pmf(discordants, n_scenes, discordant_rate) @ detects)


@lru_cache(maxsize=64)
def _critical(n_scenes: int, alpha: float, graded: bool) -> NDArray[np.int64]:
    """Return per number of discordants the largest smaller count that detects; -1: none does."""
    total = np.arange(n_scenes + 1)
    tested = unconditional.critical(n_scenes, alpha)[1] if graded else _sign_critical(total, alpha)
    # Tango's statistic of no difference is (first - second)^2 / discordants.
    excluded = np.ceil((total - quantile(LEVEL) * np.sqrt(total)) / 2.0) - 1.0
    return np.minimum(tested, np.maximum(excluded, -1.0).astype(np.int64))


def _sign_critical(total: NDArray[np.int64], alpha: float) -> NDArray[np.int64]:
    """Return [discordants]: the largest smaller count that the sign test rejects; -1: none.

    Bisected, since what is rejected also is with fewer, and first of all near the normal law's.
    """
    normal = np.floor((total - quantile(1.0 - alpha) * np.sqrt(total)) / 2.0).astype(np.int64)
    low, high = np.maximum(normal - 2, -1), np.clip(normal + 2, 0, total)
    low = np.where(binomial_cdf(low, total, 0.5) <= alpha / 2.0, low, -1)
    high = np.where(binomial_cdf(high, total, 0.5) <= alpha / 2.0, total, high)
    while len(apart := np.flatnonzero(high - low > 1)):
        middle = (low[apart] + high[apart]) // 2
        inside = binomial_cdf(middle, total[apart], 0.5) <= alpha / 2.0
        low[apart] = np.where(inside, middle, low[apart])
        high[apart] = np.where(inside, high[apart], middle)
    return low


def simulated_power(
    n_scenes: int, seeds: int, rate: float, lean: float, alike: float, alpha: float, graded: bool
) -> float:
    """Return the power of several seeds' test and score interval, from `AUDITS` simulated audits.

    In each of ``seeds`` a share ``rate`` of the scenes is discordant and favours the first variant
    with chance ``(1 + lean) / 2``. A share ``alike`` of the scenes treats all seeds alike, the
    others each for itself. The same stream serves every call, so that neighbouring powers can be
    compared.
    """
    one = np.array([rate * (1.0 - lean), 2.0 * (1.0 - rate), rate * (1.0 + lean)]) / 2.0
    apart = np.ones(1)
    for _ in range(seeds):
        apart = np.convolve(apart, one)
    chances = (1.0 - alike) * apart
    chances[[0, seeds, 2 * seeds]] += alike * one
    values, chances = np.arange(-seeds, seeds + 1) / seeds, np.maximum(chances, 0.0) / chances.sum()
    stream = generator("detectable", "", n_scenes)
    counts = stream.multinomial(n_scenes, chances, size=AUDITS).astype(np.float64)
    return float(detected(values, counts, alpha, graded).mean())


def detected(
    values: Floats, counts: Floats, alpha: float, graded: bool = False
) -> NDArray[np.bool_]:
    """Return [audits]: whether test and interval of several seeds agree.

    ``counts`` [audits, values] says how many scenes differ by each of ``values``.
    """
    if graded:
        return degrees_rejects(values, counts, 1.0, alpha)
    first = counts[:, values > 0].sum(axis=1)
    second = counts[:, values < 0].sum(axis=1)
    tested = 2.0 * binomial_cdf(np.minimum(first, second), first + second, 0.5) <= alpha
    same = np.sign(counts @ values) == np.sign(first - second)
    far = reach(values, counts, 1.0)
    return tested & same & rejects(values, counts, 0.0, far, quantile(LEVEL))


def detectable(
    pairs: Numbers,
    *,
    graded: bool = False,
    alpha: float = ALPHA,
    power: float = 0.8,
    on_top: bool = False,
) -> float | None:
    """Return the detectable difference in success (pp) of pairs [scenes, seeds]: 1, 0 or -1, and
    not a number where a pair has not both outcomes.

    None where the test cannot reject at ``alpha`` with that power, whatever the difference. As many
    pairs are taken to be discordant as were, or with all of them on one side what the difference
    needs; without any, the upper end of the 95 % Clopper-Pearson interval of their share. Seeds
    agree within a scene as often as was seen; copies of a seed count once.

    ``on_top`` takes what was seen for noise that favours neither variant, and the difference for
    wins beside it, so that pairs are discordant more often: the number to plan by.
    """
    filled = by_scene_and_seed(np.nan_to_num(pairs, nan=_MISSING), "pairs") + 0.0  # never -0.0
    # Columns as bytes: NumPy's sort of columns takes each scene for a field.
    seeds = np.stack(list({column.tobytes(): column for column in filled.T}.values()), axis=1)
    ran = seeds != _MISSING
    seeds = np.where(ran, seeds, 0.0)
    n_scenes, n_seeds = seeds.shape
    rate, alike = float(np.abs(seeds).sum() / ran.sum()), 1.0
    if rate == 0.0:
        rate = 1.0 - ((1.0 - LEVEL) / 2.0) ** (1.0 / n_scenes)
    elif n_seeds > 1:
        # Two seeds' product has the mean ``alike * rate + (1 - alike) * mean ** 2``. A little is
        # added as if seen, on either side, because few discordant pairs tell little.
        sums = seeds.sum(axis=1) ** 2 - np.abs(seeds).sum(axis=1)
        together = ran.sum(axis=1) * (
            ran.sum(axis=1) - 1
        )  # ordered pairs of seeds that a scene has
        products = n_scenes * float(sums.sum()) / max(1, int(together.sum()))
        by_chance = n_scenes * float(seeds.sum() / ran.sum()) ** 2
        seen = n_scenes * rate - by_chance + _PRIOR_SCENES
        alike = min(1.0, max(0.0, (products - by_chance + _PRIOR_ALIKE * _PRIOR_SCENES) / seen))

    def reached(difference: float) -> float:
        share = min(1.0, rate + difference if on_top else max(rate, difference))
        if alike == 1.0:
            return rule_power(n_scenes, share, difference, alpha, graded=graded)
        lean = difference / share
        return simulated_power(n_scenes, n_seeds, share, lean, alike, alpha, graded)

    if reached(1.0) < power:
        return None
    low, high = 0.0, 1.0
    while high - low > _PRECISION * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reached(middle) >= power else (middle, high)
    return 100.0 * high
