"""Power of test and score interval together, and the least difference that they detect.

That difference is shown beside every "not significant", which does not mean equal. There is none
for newly trained models: a few trainings do not determine their own spread.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from faultpath.core.streams import generator
from faultpath.stats import unconditional
from faultpath.stats.distributions import binomial_cdf, binomial_pmf, likely
from faultpath.stats.estimate import ALPHA, FixedSize
from faultpath.stats.inputs import Floats, Numbers, by_scene_and_seed
from faultpath.stats.score import degrees_rejects, quantile, reach, rejects

LEVEL = 0.95
"""Level of the interval that has to exclude 0 too."""
POWER = 0.8
AUDITS = 2000
"""Simulated audits, where power has no closed form."""
_PRECISION = 1e-3
_MISSING = 2.0
"""Marks a pair with a missing outcome, where columns of pairs are compared."""
_PRIOR_ALIKE, _PRIOR_SCENES = 0.5, 1.0
"""Prior counts of seeds that end alike."""


def fewest_scenes(alpha: float = ALPHA) -> int:
    """Return the least number of scenes with which a test at ``alpha`` can reject.

    If all favour one variant, sign test and E+M test have the same p, ``2 ** (1 - scenes)``.
    """
    return int(np.ceil(1.0 + np.log2(1.0 / alpha) - 1e-12))


MIN_SCENES = fewest_scenes()
"""With fewer scenes nothing can be significant at 0.05."""


def rule_power(
    n_scenes: int,
    discordant_rate: float,
    difference: float,
    alpha: float = ALPHA,
    *,
    test: FixedSize = "unconditional",
) -> float:
    """Return the exact power of one seed's test at ``alpha`` together with Tango's 95 % interval.

    Each of ``n_scenes`` pairs is discordant with probability ``discordant_rate``, above 0, and the
    success probabilities differ by ``difference`` (fractions, |difference| <= discordant_rate). The
    number of discordant pairs is enumerated, and the binomial of their split is summed in closed
    form.
    """
    first, last = likely(n_scenes, discordant_rate, discordant_rate)
    discordants = np.arange(first, last + 1)
    critical = _critical(n_scenes, alpha, test)[discordants]
    favour = 0.5 * (1.0 + abs(difference) / discordant_rate)
    detects = binomial_cdf(critical, discordants, favour)
    detects = detects + binomial_cdf(critical, discordants, 1.0 - favour)
    return float(binomial_pmf(discordants, n_scenes, discordant_rate) @ detects)


@lru_cache(maxsize=64)
def _critical(n_scenes: int, alpha: float, test: FixedSize) -> NDArray[np.int64]:
    """Return [discordants]: the largest smaller count that is significant; -1: none."""
    total = np.arange(n_scenes + 1)
    if test == "unconditional":
        tested = unconditional.critical(n_scenes, alpha)[1]
    else:
        tested = _sign_critical(total, alpha)
    # Tango's statistic of no difference is (first - second)^2 / discordants.
    excluded = np.ceil((total - quantile(LEVEL) * np.sqrt(total)) / 2.0) - 1.0
    return np.minimum(tested, np.maximum(excluded, -1.0).astype(np.int64))


def _sign_critical(total: NDArray[np.int64], alpha: float) -> NDArray[np.int64]:
    """Return [discordants]: the largest smaller count that the sign test rejects; -1: none.

    Bisected, since a smaller count is rejected too, and first near the normal approximation.
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
    n_scenes: int, seeds: int, rate: float, lean: float, alike: float, alpha: float, test: FixedSize
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
    return float(significant(values, counts, alpha, test).mean())


def significant(
    values: Floats, counts: Floats, alpha: float, test: FixedSize = "unconditional"
) -> NDArray[np.bool_]:
    """Return [audits]: whether test and interval of several seeds find the same side ahead.

    ``counts`` [audits, values] says how many scenes differ by each of ``values``.
    """
    if test == "unconditional":
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
    test: FixedSize = "unconditional",
    alpha: float = ALPHA,
    on_top: bool = False,
) -> float | None:
    """Return the difference in success (pp) detected with 80 % power, given an audit's pairs.

    ``pairs`` [scenes, seeds] are 1, 0 or -1, and NaN where an outcome is missing.

    None where the test cannot reject at ``alpha`` with that power, whatever the difference. The
    share of discordant pairs is the observed one, or if larger the difference itself; with none
    observed, the upper end of its 95 % Clopper-Pearson interval. Seeds of a scene agree as often as
    observed; copies of a seed count once.

    With ``on_top`` the observed discordant pairs are noise that favours neither variant and the
    difference comes on top of them, so that more pairs are discordant: the number to plan by.
    """
    filled = by_scene_and_seed(np.nan_to_num(pairs, nan=_MISSING), "pairs") + 0.0  # never -0.0
    # Columns as bytes: NumPy's sort of columns takes each scene for a field.
    seeds = np.stack(list({column.tobytes(): column for column in filled.T}.values()), axis=1)
    ran = seeds != _MISSING
    seeds = np.where(ran, seeds, 0.0)
    n_scenes, n_seeds = seeds.shape
    rate = float(np.abs(seeds).sum() / ran.sum())
    alike = _share_alike(seeds, ran, rate) if rate > 0.0 and n_seeds > 1 else 1.0
    if rate == 0.0:
        rate = 1.0 - ((1.0 - LEVEL) / 2.0) ** (1.0 / n_scenes)

    def reached(difference: float) -> float:
        share = min(1.0, rate + difference if on_top else max(rate, difference))
        if alike == 1.0:
            return rule_power(n_scenes, share, difference, alpha, test=test)
        lean = difference / share
        return simulated_power(n_scenes, n_seeds, share, lean, alike, alpha, test)

    if reached(1.0) < POWER:
        return None
    low, high = 0.0, 1.0
    while high - low > _PRECISION * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reached(middle) >= POWER else (middle, high)
    return 100.0 * high


def _share_alike(seeds: Floats, ran: NDArray[np.bool_], rate: float) -> float:
    """Return the estimated share of scenes that treat all seeds alike.

    Two seeds' product has the mean ``alike * rate + (1 - alike) * mean ** 2``. Prior counts are
    added on either side, because few discordant pairs tell little.
    """
    n_scenes = len(seeds)
    sums = seeds.sum(axis=1) ** 2 - np.abs(seeds).sum(axis=1)
    together = ran.sum(axis=1) * (ran.sum(axis=1) - 1)  # ordered pairs of a scene's seeds
    products = n_scenes * float(sums.sum()) / max(1, int(together.sum()))
    by_chance = n_scenes * float(seeds.sum() / ran.sum()) ** 2
    seen = n_scenes * rate - by_chance + _PRIOR_SCENES
    return min(1.0, max(0.0, (products - by_chance + _PRIOR_ALIKE * _PRIOR_SCENES) / seen))
