"""How often a true difference of the reported detectable size is detected."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from faultpath.selfcheck.coverage import PRIOR, tables
from faultpath.selfcheck.model import Measured
from faultpath.selfcheck.populations import Population
from faultpath.statistics import IN_FORCE, detectable
from faultpath.statistics.distributions import binomial_pmf, multinomial_pmf, multinomial_ways
from faultpath.statistics.inputs import Floats
from faultpath.statistics.power import detected
from faultpath.statistics.score import reach
from faultpath.streams import generator

DETECTION = "detectable difference"
_AGAIN = 400
"""Audits simulated at each reported difference."""
_NEVER = 1e-12
"""Chance of a number of discordant scenes that is too small to show in what is measured."""


@dataclass(frozen=True)
class DetectionAtTheReported:
    """Audits of equal arms report what they could have detected; then that is made the truth."""

    scenes: int
    population: Population
    alpha: float
    runs: int

    def measure(self) -> Measured:
        """Return the mean share of audits that detect the difference reported by others.

        Exact for one seed. Else the stated runs are not the reports: they are as many audits as
        would have the standard error of the mean of the reports' shares.
        """
        truth = self.population
        powers, runs = (self._exactly(), 0) if truth.seeds == 1 else self._simulated()
        setting = {
            "scenes": self.scenes,
            "seeds": truth.seeds,
            "rate": truth.rate,
            "alike": truth.alike,
            "alpha": round(self.alpha, 4),
        }
        return Measured(DETECTION, setting, powers, runs)

    def _exactly(self) -> float:
        every, numbers = tables(self.scenes), np.arange(self.scenes + 1)
        every = every[
            detected(self.population.sizes, every, np.ones(len(every)), self.alpha, IN_FORCE)
        ]
        ways = multinomial_ways(every)
        chances = binomial_pmf(numbers, self.scenes, self.population.rate)
        total = weights = 0.0
        for discordant in np.flatnonzero(chances > _NEVER):
            least = self._reported((numbers[1:] <= discordant).astype(np.float64))
            if least is not None:
                found = multinomial_pmf(every, self._at(least).chances(), ways).sum()
                weights += float(chances[discordant])
                total += float(chances[discordant] * found)
        return total / weights

    def _simulated(self) -> tuple[float, int]:
        stream = generator("selfcheck", repr(self), 0)
        truth, shares = self.population, list[float]()
        for _ in range(self.runs):
            difference = truth.outcomes(stream.random((self.scenes, truth.seeds + 2)))
            least = self._reported(difference)
            if least is not None:
                true = self._at(least)
                drawn = stream.multinomial(self.scenes, true.chances(), size=_AGAIN)
                counts = drawn.astype(np.float64)
                far = reach(true.sizes, counts, 1.0, PRIOR)
                shares.append(float(detected(true.sizes, counts, far, self.alpha, IN_FORCE).mean()))
        mean = float(np.mean(shares))
        variance = float(np.var(shares)) / len(shares)
        return mean, round(mean * (1.0 - mean) / variance) if variance else len(shares)

    def _reported(self, difference: Floats) -> float | None:
        least = detectable(difference > 0.0, difference < 0.0, rule=IN_FORCE, alpha=self.alpha)
        return None if least is None else least / 100.0

    def _at(self, difference: float) -> Population:
        rate = max(self.population.rate, difference)
        return replace(self.population, rate=rate, lean=min(1.0, difference / rate))


def detection_grid(runs: int) -> Iterator[DetectionAtTheReported]:
    """Yield the grid: alone, and at the strictest level of a family of seven."""
    kinds = ((1, 0.0), (3, 0.0), (3, 0.5))
    levels = (0.05, 0.05 / 7)
    for n, (seeds, alike), rate, alpha in product(
        (25, 50, 100, 300), kinds, (0.02, 0.1, 0.3), levels
    ):
        yield DetectionAtTheReported(n, Population(rate, 0.0, seeds, alike), alpha, runs)
