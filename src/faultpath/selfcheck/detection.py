"""How often a true difference of the reported detectable size is detected."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from faultpath.selfcheck.model import Measured
from faultpath.selfcheck.populations import Population
from faultpath.statistics import detectable
from faultpath.statistics.power import detected
from faultpath.statistics.score import reach
from faultpath.streams import generator

DETECTION = "detectable difference"
_AGAIN = 400
"""Audits simulated at each reported difference."""


@dataclass(frozen=True)
class DetectionAtTheReported:
    """Audits of equal arms report what they could have detected; then that is made the truth."""

    scenes: int
    population: Population
    alpha: float
    runs: int

    def measure(self) -> Measured:
        """Return the mean share of audits that detect the difference reported by others."""
        found: list[float] = []
        stream = generator("selfcheck", repr(self), 0)
        truth = self.population
        for _ in range(self.runs):
            difference = truth.outcomes(stream.random((self.scenes, truth.seeds + 2)))
            least = detectable(difference > 0.0, difference < 0.0, alpha=self.alpha).value
            if least is not None:
                found.append(self._detected(least / 100.0, stream))
        setting = {
            "scenes": self.scenes,
            "seeds": truth.seeds,
            "rate": truth.rate,
            "alike": truth.alike,
            "alpha": round(self.alpha, 4),
        }
        return Measured(DETECTION, setting, float(np.mean(found)), self.runs)

    def _detected(self, difference: float, stream: np.random.Generator) -> float:
        """Return the share at a true difference: as many scenes differ, more where it needs it."""
        rate = max(self.population.rate, difference)
        true = replace(self.population, rate=rate, lean=min(1.0, difference / rate))
        counts = stream.multinomial(self.scenes, true.chances(), size=_AGAIN).astype(np.float64)
        far = reach(np.broadcast_to(true.sizes, counts.shape), counts, 1.0)
        return float(detected(true.sizes, counts, far, self.alpha).mean())


def detection_grid(runs: int) -> Iterator[DetectionAtTheReported]:
    """Yield the grid: alone, and at the strictest level of a family of seven."""
    for n in (25, 50, 100, 300):
        for seeds, alike in ((1, 0.0), (3, 0.0), (3, 0.5)):
            for rate in (0.02, 0.1, 0.3):
                for alpha in (0.05, 0.05 / 7):
                    truth = Population(rate, 0.0, seeds, alike)
                    yield DetectionAtTheReported(n, truth, alpha, runs)
