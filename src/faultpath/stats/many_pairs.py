"""The E+M test (`unconditional`) of too many pairs to sum E for every table.

*E* only orders the tables, so it may be approximated: up to `_SUMMED` discordant pairs it is summed
exactly; beyond, it is the normal probability of ``z`` with Edgeworth's next term. The binomial's
steps need no correction, since E averages over even and odd numbers of discordant pairs, unless all
pairs are discordant. *M* is still the largest probability over all shares, so the level holds.

It takes some ``n_pairs`` operations for each share of discordant pairs, not their square.
"""

from functools import cached_property

import numpy as np

from faultpath.stats.distributions import (
    binomial_cdf,
    binomial_pmf,
    likely,
    log_factorials,
    normal_quantile,
    normal_tails,
)
from faultpath.stats.inputs import Floats
from faultpath.stats.null_law import Counts, EStep, bounds, sign_tails

_SUMMED, _ROWS = 256, 480
"""Largest number of discordant pairs for which E is summed, and the largest that is then expected:
at least 12 standard deviations more."""
_LAST = 16
"""Numbers of discordant pairs, down from all pairs, at which the binomial's steps matter."""
_PEAKS, _FINER = 3, 9
"""As in `null_law`; shares lie less than a standard deviation apart."""

_NEAR, _BEYOND = 1e-7, 1e-4
"""Relative precision of the critical probability, and overshoot of steps towards it."""


class ManyPairs:
    """Distribution of tables of one large number of pairs under no difference."""

    def __init__(self, n_pairs: int) -> None:
        self.n_pairs = n_pairs
        few = np.arange(_SUMMED + 1.0)
        others = np.broadcast_to(np.arange(_ROWS + 1), (_SUMMED + 1, _ROWS + 1))
        self.e_step = EStep(
            sign_tails(_ROWS), others, binomial_pmf(others, n_pairs, few[:, np.newaxis] / n_pairs)
        )
        self.logs = log_factorials(n_pairs)
        points = 32 + 4 * int(np.ceil(np.sqrt(n_pairs)))
        self.shares: Floats = np.sin(np.linspace(0.0, np.pi / 2.0, points)) ** 2

    def chance(self, z: Floats, discordants: Floats) -> Floats:
        """Return [tables]: the E step's probability; discordant pairs need not be whole numbers."""
        discordants = np.minimum(discordants, self.n_pairs)
        many = np.maximum(discordants, 1.0)
        z_even = np.maximum(z - self._step(many) / np.sqrt(many), 0.0)
        chance = normal_tails(z_even + (z_even**3 - 3.0 * z_even) / (12.0 * many))
        few = discordants <= _SUMMED
        share = discordants[few, np.newaxis] / self.n_pairs
        others = np.broadcast_to(np.arange(_ROWS + 1), (len(share), _ROWS + 1))
        chances = binomial_pmf(others, self.n_pairs, share)
        chance[few] = self.e_step.chance(z[few], others, chances)
        return chance

    def region(self, chance: float, inside: Counts, outside: Counts) -> Counts:
        """Return [discordants]: the largest smaller count at least as extreme as ``chance``."""
        few = slice(0, _SUMMED + 1)
        region = np.empty(self.n_pairs + 1, dtype=np.int64)
        region[few] = self.e_step.region(chance, inside[few], outside[few])
        total = np.arange(_SUMMED + 1.0, self.n_pairs + 1.0)
        # The real root of z^3 + (12 total - 3) z = 12 total * normal quantile, Edgeworth's term.
        slope = 12.0 * total - 3.0
        turned = np.arcsinh(
            18.0 * total * -normal_quantile(0.5 * chance) / slope * np.sqrt(3.0 / slope)
        )
        z = 2.0 * np.sqrt(slope / 3.0) * np.sinh(turned / 3.0)
        fewer = np.floor((total - self._step(total) - z * np.sqrt(total)) / 2.0 + 1e-9)
        region[_SUMMED + 1 :] = np.clip(fewer, -1.0, (total - 1.0) // 2.0)
        return region

    def critical(self, alpha: float) -> tuple[float, Counts]:
        """Return the largest probability with a p of at most ``alpha``, and its region.

        The p is nearly proportional to the E step's probability, which gives the next trial value,
        plus a little overshoot to close in from both sides; every third step halves the interval.
        """
        inside, outside = bounds(self.n_pairs)
        low, high, aim, step = 0.0, 1.0, alpha, 0
        while high - low > _NEAR * high:
            if step % 3 == 2 or not low < aim < high:
                aim = 0.5 * (low + high)
            region = self.region(aim, inside, outside)
            worst = self.worst(region, limit=alpha)
            if worst <= alpha:
                low, inside = aim, region
            else:
                high, outside = aim, region
            beyond = 1.0 + _BEYOND if worst <= alpha else 1.0 - _BEYOND
            aim, step = aim * beyond * alpha / max(worst, 1e-300), step + 1
        return low, inside

    def worst(self, region: Counts, limit: float = 1.0) -> float:
        """Return the largest probability of a region over the shares of discordant pairs.

        Above ``limit`` it is not refined.
        """
        often = self._often(region)
        inner = [chances @ often[first : first + len(chances)] for first, chances in self.mixed]
        at = np.array([0.0, *inner, often[-1]])  # at no and at all pairs discordant
        best = float(at.max())
        if best > limit:
            return best
        peaks = np.flatnonzero((at[1:-1] >= at[:-2]) & (at[1:-1] >= at[2:])) + 1
        for peak in peaks[np.argsort(-at[peaks])][:_PEAKS]:
            low, high = self.shares[peak - 1], self.shares[peak + 1]
            for _ in range(2):
                finer = np.linspace(low, high, _FINER + 2)
                first, chances = self._mixed(finer[1:-1])
                close = chances @ often[first : first + chances.shape[1]]
                top = int(close.argmax())
                low, high = finer[top], finer[top + 2]
                best = max(best, float(close[top]))
        return min(1.0, best)

    @cached_property
    def mixed(self) -> list[tuple[int, Floats]]:
        """By inner share: the first likely number of discordant pairs, and the probabilities of it
        and of the following ones."""
        parts = (self._mixed(share) for share in self.shares[1:-1, np.newaxis])
        return [(first, chances[0]) for first, chances in parts]

    def _mixed(self, shares: Floats) -> tuple[int, Floats]:
        """Return the first likely number of discordant pairs, and probabilities [shares,
        likely]."""
        size = self.n_pairs
        first, last = likely(size, float(shares[0]), float(shares[-1]))
        total = np.arange(first, last + 1)
        ways = self.logs[size] - self.logs[total] - self.logs[size - total]
        odds = np.log(shares)[:, np.newaxis], np.log1p(-shares)[:, np.newaxis]
        return first, np.exp(ways + total * odds[0] + (size - total) * odds[1])

    def _often(self, region: Counts) -> Floats:
        """Return [discordants]: the probability of the region given each number of discordant
        pairs.

        Beyond `_SUMMED` it follows by recursion: one more discordant pair takes half of the
        probability at the region's edge out, and a wider region takes it in.
        """
        few, last = np.arange(_SUMMED + 1), self.n_pairs + 1 - _LAST
        edge = region[_SUMMED + 1 : last]
        grows = np.diff(edge)
        taken = edge[:-1] + grows
        total = np.arange(_SUMMED + 1, last - 1)
        lower = np.maximum(taken, 0)
        chance = (
            self.logs[total] - self.logs[lower] - self.logs[total - lower] - total * np.log(2.0)
        )
        step = np.where(taken < 0, 0.0, np.exp(chance)) * (2 * grows - 1)
        start = 2.0 * binomial_cdf(edge[:1], total[:1], 0.5)
        ends = np.arange(last, self.n_pairs + 1)
        return np.concatenate(
            [
                self.e_step.tails[few, region[few] + 1],
                np.maximum(np.cumsum(np.concatenate([start, step])), 0.0),
                2.0 * binomial_cdf(region[last:], ends, 0.5),
            ]
        )

    def _step(self, discordants: Floats) -> Floats:
        """Return [tables]: the correction of the counts' difference for the binomial's steps.

        It is 1 where all pairs are discordant, because their number is then no longer even or odd
        at random.
        """
        concordant = self.n_pairs - discordants
        step, last = np.zeros_like(concordant), concordant < _LAST
        step[last] = (1.0 - 2.0 * concordant[last] / self.n_pairs) ** self.n_pairs
        return step
