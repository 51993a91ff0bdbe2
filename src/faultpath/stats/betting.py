"""Tests and intervals of a mean of bounded scene values that are valid at any stopping time.

A bettor against "the mean is at most ``null``" starts with a capital of 1 and stakes a share ``c``
of it on each scene: the capital is multiplied by ``1 - c + c (bound + value) / (bound + null)``.
Under the null no bet has a positive expected gain, so the capital ever reaches ``1 / alpha`` with
probability at most ``alpha`` (Ville's inequality), however often it is checked.

The capital here is the mean over many shares at once, Robbins' mixture martingale (Annals of
Mathematical Statistics 41:1397, 1970), with the arcsine law of Krichevsky and Trofimov: for one
seed of binary outcomes it is that of discordant pairs. The nulls that are not rejected are a
confidence sequence (Waudby-Smith and Ramdas, Journal of the Royal Statistical Society B 86:1,
2024). A mixture of shares is a product over scenes, so it does not depend on their order.
"""

import numpy as np
from numpy.typing import NDArray

from faultpath.stats.inputs import Floats

_SHARES = np.sin((np.arange(32) + 0.5) * np.pi / 64.0)
"""Shares staked, with equal weights: quantiles of the arcsine law, all below 1."""
_HALVINGS = 44


def log_capital(
    values: Floats, counts: Floats, null: Floats | float, bound: Floats | float
) -> Floats:
    """Return [...]: the logarithm of the capital against "the mean is at most ``null``".

    ``counts`` [..., values] are the numbers of scenes with each of ``values``, which are at most
    ``bound`` [...] from 0; ``null`` [...] is above ``-bound``.
    """
    bound, null = np.asarray(bound), np.asarray(null, dtype=np.float64)
    gain = (bound[..., np.newaxis] + values) / (bound + null)[..., np.newaxis]
    factors = np.log1p(_SHARES * (gain[..., np.newaxis] - 1.0))
    logs = (counts[..., np.newaxis] * factors).sum(axis=-2)
    top = logs.max(axis=-1)
    mean = np.exp(logs - top[..., np.newaxis]).mean(axis=-1)
    return np.asarray(top + np.log(mean), dtype=np.float64)


def p_value(values: Floats, counts: Floats, bound: float) -> tuple[float, int]:
    """Return the two-sided p of "the mean is 0", and the side of 0 on which the mean seems to be.

    The probability that it is ever at most ``alpha`` is at most ``alpha``.
    """
    above = float(log_capital(values, counts, 0.0, bound))
    below = float(log_capital(-values[::-1], counts[::-1], 0.0, bound))
    return min(1.0, 2.0 * float(np.exp(-max(above, below)))), (above > below) - (above < below)


def rejects(
    values: Floats, counts: Floats, null: float, bound: Floats | float, level: float
) -> NDArray[np.bool_]:
    """Return [...]: whether ``null`` lies outside the confidence sequence at ``level``."""
    sides = (
        log_capital(values, counts, null, bound) >= _needed(level),
        log_capital(-values[..., ::-1], counts[..., ::-1], -null, bound) >= _needed(level),
    )
    return np.logical_or(*sides)


def interval(values: Floats, counts: Floats, bound: Floats, level: float) -> tuple[Floats, Floats]:
    """Return both ends [...] of the confidence sequence at ``level``.

    The upper end is the mirrored lower end of the negated values: with ascending ``values``,
    swapping the variants mirrors the interval to the bit.
    """
    mirrored = _low(-values[..., ::-1], counts[..., ::-1], bound, level)
    return _low(values, counts, bound, level), 0.0 - mirrored


def fewest_scenes(alpha: float) -> int:
    """Return the least number of scenes with which p can be at most ``alpha``: all favour one
    variant."""
    scenes = 1
    while p_value(np.ones(1), np.full(1, float(scenes)), 1.0)[0] > alpha:
        scenes += 1
    return scenes


def _needed(level: float) -> float:
    return float(np.log(2.0 / (1.0 - level)))


def _low(values: Floats, counts: Floats, bound: Floats, level: float) -> Floats:
    needed = _needed(level)
    low: Floats = 0.0 - np.asarray(bound, dtype=np.float64)
    high: Floats = (counts * values).sum(axis=-1) / counts.sum(axis=-1)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        # If all values are at the lower bound, so are both ends, and no null there is rejected.
        null = np.where(middle > -np.asarray(bound), middle, high + 1.0)
        rejected = log_capital(values, counts, null, bound) >= needed
        low, high = np.where(rejected, middle, low), np.where(rejected, high, middle)
    return np.asarray(low, dtype=np.float64)
