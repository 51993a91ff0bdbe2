"""The few distribution functions that the tests and power need, typed.

SciPy ships no type stubs, so all untyped calls are in this file. ``scipy.special`` is used
rather than ``scipy.stats``: it is exact enough, far faster on arrays and quick to import. SciPy
loads it with the first call, so that what only reads estimates does without.
"""
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false

import numpy as np
import scipy
from numpy.typing import ArrayLike

from faultpath.stats.inputs import Floats


def binomial_cdf(successes: ArrayLike, trials: ArrayLike, probability: ArrayLike) -> Floats:
    """Return P(X <= successes), broadcast; 0 below 0 and 1 from ``trials`` on."""
    k, n, p = np.broadcast_arrays(
        *(np.asarray(x, dtype=np.float64) for x in (successes, trials, probability))
    )
    inside = (k >= 0) & (k < n)
    result = np.where(k < 0, 0.0, 1.0)
    result[inside] = scipy.special.betainc(n[inside] - k[inside], k[inside] + 1.0, 1.0 - p[inside])
    return result


def binomial_pmf(successes: ArrayLike, trials: int, probability: ArrayLike) -> Floats:
    """Return P(X = successes), broadcast."""
    k = np.asarray(successes, dtype=np.float64)
    choose = scipy.special.gammaln(trials + 1.0) - scipy.special.gammaln(k + 1.0)
    choose = choose - scipy.special.gammaln(trials - k + 1.0)
    share = np.asarray(probability, dtype=np.float64)
    chance = scipy.special.xlogy(k, share) + scipy.special.xlog1py(trials - k, -share)
    return np.asarray(np.exp(choose + chance), dtype=np.float64)


def likely(trials: int, lowest: float, highest: float) -> tuple[int, int]:
    """Return the first and last likely number of successes, at probabilities between two.

    Beyond 9 standard deviations plus 40 a binomial has a probability below 1e-16, by Bernstein's
    inequality.
    """
    spreads = [9.0 * np.sqrt(trials * share * (1.0 - share)) + 40.0 for share in (lowest, highest)]
    first, last = trials * lowest - spreads[0], trials * highest + spreads[1]
    return max(0, int(first)), min(trials, int(np.ceil(last)))


def log_factorials(most: int) -> Floats:
    """Return the logarithms of the factorials of 0 to ``most``."""
    return np.asarray(scipy.special.gammaln(np.arange(1.0, most + 2.0)), dtype=np.float64)


def sign_p_value(first: int, second: int) -> float:
    """Return the exact two-sided binomial p of ``first`` against ``second`` at even odds."""
    return min(1.0, 2.0 * float(binomial_cdf(min(first, second), first + second, 0.5)))


def t_p_value(values: Floats, least_variance: float = 0.0) -> float:
    """Return the two-sided p of Student's t test that ``values`` [n] have mean 0; 1 if all are 0.

    Their variance counts as ``least_variance`` at least.
    """
    mean = float(values.mean())
    if mean == 0.0 or len(values) < 2:
        return 1.0
    error = np.sqrt(max(float(values.var(ddof=1)), least_variance) / len(values))
    if error == 0.0:
        return 0.0
    return min(1.0, 2.0 * float(scipy.special.stdtr(len(values) - 1.0, -abs(mean) / error)))


def t_interval(values: Floats, level: float, least_variance: float = 0.0) -> tuple[Floats, Floats]:
    """Return both ends [...] of Student's interval of the mean of ``values`` [..., n].

    It excludes 0 where `t_p_value` is below ``1 - level``.
    """
    n = values.shape[-1]
    error = np.sqrt(np.maximum(values.var(axis=-1, ddof=1), least_variance) / n)
    half = float(scipy.special.stdtrit(n - 1.0, (1.0 + level) / 2.0)) * error
    mean = values.mean(axis=-1)
    return np.asarray(mean - half), np.asarray(mean + half)


def normal_quantile(probability: float) -> float:
    """Return the standard normal quantile."""
    return float(scipy.special.ndtri(probability))


def normal_tails(z: ArrayLike) -> Floats:
    """Return the two-sided tail probabilities of the standard normal distribution at ``z``."""
    return np.asarray(2.0 * scipy.special.ndtr(-np.abs(z)), dtype=np.float64)
