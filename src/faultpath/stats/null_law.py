"""Both steps of the E+M test (`unconditional`), summed exactly over all tables."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from faultpath.stats.distributions import binomial_pmf
from faultpath.stats.inputs import Floats

Counts = NDArray[np.int64]

TIE = 1e-9
"""Relative difference below which two tables are equally extreme, up to rounding."""
_SPREAD = 9.0
"""Standard deviations beyond which a number of discordant pairs is neglected."""
_PEAKS, _FINER = 3, 25
"""Peaks of the probability over the shares that are refined, and the points of each refinement."""


class EStep(NamedTuple):
    """Probabilities of other numbers of discordant pairs, given each observed number."""

    tails: Floats
    """[discordants, 1 + fewer]: probability of at most this smaller count on either side."""
    others: Counts
    """[discordants, expected]: likely numbers of discordant pairs, given the observed one."""
    chances: Floats
    """[discordants, expected]: their probabilities."""

    def chance(self, z: Floats, others: Counts, chances: Floats) -> Floats:
        """Return [tables]: the probability of a statistic of at least ``z``, given those of
        `near`."""
        apart = z[:, np.newaxis] * np.sqrt(others)
        # The tolerance only matters where both are equal but for rounding.
        most = np.maximum(np.floor((others - apart) / 2.0 + 1e-9), -1.0).astype(np.int64)
        most[others == 0] = -1
        return (chances * self.tails[others, most + 1]).sum(axis=1)

    def region(self, chance: float, inside: Counts, outside: Counts) -> Counts:
        """Return [discordants]: the largest smaller count at least as extreme as ``chance``.

        It is bisected between the regions ``inside`` and ``outside``, since a table with a smaller
        count is more extreme.
        """
        low, high = inside.copy(), outside + 1
        high[0] = 0
        while len(total := np.flatnonzero(high - low > 1)):
            middle = (low[total] + high[total]) // 2
            z = (total - 2 * middle) / np.sqrt(np.maximum(total, 1))
            chances = self.chance(z, self.others[total], self.chances[total])
            within = chances <= chance * (1.0 + TIE)
            low[total] = np.where(within, middle, low[total])
            high[total] = np.where(within, high[total], middle)
        return low


class NullLaw:
    """Distribution of tables of one number of pairs under no difference."""

    def __init__(self, n_pairs: int) -> None:
        self.n_pairs = n_pairs
        self.e_step = EStep(sign_tails(n_pairs), *near(n_pairs, np.arange(n_pairs + 1.0)))
        points = 32 + 16 * int(np.ceil(np.sqrt(n_pairs)))
        self.shares: Floats = np.sin(np.linspace(0.0, np.pi / 2.0, points)) ** 2
        """Shares of discordant pairs over which the probability is maximised."""
        self.mixed = _mixed(n_pairs, self.shares)
        """[shares, discordants]: probability of each number of discordant pairs."""

    def chance(self, z: Floats, discordants: Floats) -> Floats:
        """Return [tables]: the E step's probability; discordant pairs need not be whole numbers."""
        return self.e_step.chance(z, *near(self.n_pairs, discordants))

    def region(self, chance: float, inside: Counts, outside: Counts) -> Counts:
        """Return the region of the E step."""
        return self.e_step.region(chance, inside, outside)

    def critical(self, alpha: float) -> tuple[float, Counts]:
        """Return the largest probability with a p of at most ``alpha``, and its region."""
        inside, outside = bounds(self.n_pairs)
        low, high = 0.0, 1.0
        while high - low > TIE * high:
            middle = 0.5 * (low + high)
            region = self.region(middle, inside, outside)
            if self.worst(region, limit=alpha) <= alpha:
                low, inside = middle, region
            else:
                high, outside = middle, region
        return low, inside

    def worst(self, region: Counts, limit: float = 1.0) -> float:
        """Return the largest probability of a region over the shares of discordant pairs.

        Above ``limit`` it is not refined.
        """
        often = self.e_step.tails[np.arange(len(region)), region + 1]
        at = self.mixed @ often
        if at.max() > limit:
            return float(at.max())
        inner = np.flatnonzero((at[1:-1] >= at[:-2]) & (at[1:-1] >= at[2:])) + 1
        best = float(at.max())
        for peak in inner[np.argsort(-at[inner])][:_PEAKS]:
            low, high = self.shares[peak - 1], self.shares[peak + 1]
            for _ in range(2):
                finer = np.linspace(low, high, _FINER)
                near_peak = _mixed(len(region) - 1, finer) @ often
                top = int(near_peak.argmax())
                low, high = finer[max(top - 1, 0)], finer[min(top + 1, _FINER - 1)]
                best = max(best, float(near_peak[top]))
        return min(1.0, best)


def bounds(n_pairs: int) -> tuple[Counts, Counts]:
    """Return the regions of no table, and of all tables whose counts differ."""
    total = np.arange(n_pairs + 1)
    return np.full_like(total, -1), (total - 1) // 2


def sign_tails(most: int) -> Floats:
    """Return [discordants, 1 + fewer]: probability of at most this smaller count on either side."""
    split = np.zeros(most // 2 + 2)  # of one more discordant pair with each row of the tails
    split[0] = 1.0
    tails = np.zeros((most + 1, len(split)))
    for total in range(most + 1):
        if total:
            split[1:] = 0.5 * (split[1:] + split[:-1])
            split[0] *= 0.5
        tails[total, 1:] = np.minimum(1.0, 2.0 * np.cumsum(split[:-1]))
    return tails


def near(n_pairs: int, discordants: Floats) -> tuple[Counts, Floats]:
    """Return [tables, expected]: likely numbers of discordant pairs, given the observed one, and
    their probabilities."""
    width = min(n_pairs + 1, 2 * int(np.ceil(_SPREAD * np.sqrt(n_pairs) / 2.0)) + 1)
    start = np.clip(np.rint(discordants).astype(np.int64) - width // 2, 0, n_pairs + 1 - width)
    others = start[:, np.newaxis] + np.arange(width)
    share = np.minimum(discordants / n_pairs, 1.0)[:, np.newaxis]
    return others, binomial_pmf(others, n_pairs, share)


def _mixed(n_pairs: int, shares: Floats) -> Floats:
    return binomial_pmf(np.arange(n_pairs + 1), n_pairs, shares[:, np.newaxis])
