"""How often the intervals of an effect and of a break-even frequency hold the truth."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from faultpath.selfcheck.model import Measured
from faultpath.selfcheck.populations import RATES, Population, joint
from faultpath.statistics import Resamples, success_effect
from faultpath.statistics.distributions import multinomial_pmf
from faultpath.statistics.inputs import Floats
from faultpath.statistics.rules import IN_FORCE, RULES
from faultpath.statistics.score import quantile, reach, rejects
from faultpath.streams import generator

Z = quantile(0.95)
PRIOR = RULES[IN_FORCE].prior
LEANS = (0.0, 0.5, 1.0)
INTERVAL, BREAK_EVEN, MODELS = "interval", "break-even", "newly trained models"
_SLACK = 1e-9


@dataclass(frozen=True)
class IntervalCoverage:
    """Coverage of the 95 % interval of an effect; exact for one seed."""

    scenes: int
    population: Population
    runs: int

    def measure(self) -> Measured:
        """Return the coverage."""
        truth, sizes = self.population, self.population.sizes
        if truth.seeds == 1:
            counts = tables(self.scenes)
            weight = multinomial_pmf(counts, truth.chances())
            runs = 0
        else:
            stream = generator("selfcheck", repr(self), 0)
            drawn = stream.multinomial(self.scenes, truth.chances(), size=self.runs)
            counts, times = np.unique(drawn.astype(np.float64), axis=0, return_counts=True)
            weight, runs = times / self.runs, self.runs
        far = reach(sizes, counts, 1.0, PRIOR)
        covered = ~rejects(sizes, counts, truth.mean, far, Z)
        setting = {
            "scenes": self.scenes,
            "seeds": truth.seeds,
            "rate": truth.rate,
            "lean": truth.lean,
            "alike": truth.alike,
            "seed effects": int(truth.seed_effects),
            "differing": round(self.scenes * (1.0 - float(truth.chances()[truth.seeds])), 3),
        }
        return Measured(INTERVAL, setting, float(weight @ covered), runs)


@dataclass(frozen=True)
class BreakEvenCoverage:
    """Coverage of the set of frequencies at which it is not decided who is ahead."""

    scenes: int
    correct: Population
    faulty: Population
    runs: int

    def measure(self) -> Measured:
        """Return how often the true frequency is in the set: the mixture there is not rejected."""
        first, second = self.correct, self.faulty
        p = first.mean / (first.mean - second.mean)
        kinds = len(first.sizes)
        stream = generator("selfcheck", repr(self), 0)
        drawn = stream.multinomial(
            self.scenes, joint(first, second, 0.5).ravel(), size=self.runs
        ).astype(np.float64)
        counts, times = np.unique(drawn, axis=0, return_counts=True)
        square = counts.reshape(-1, kinds, kinds)
        far_0 = reach(first.sizes, square.sum(axis=2), 1.0, PRIOR)
        far_f = reach(second.sizes, square.sum(axis=1), 1.0, PRIOR)
        mixed = (1.0 - p) * first.sizes[:, np.newaxis] + p * second.sizes
        far = (1.0 - p) * far_0 + p * far_f
        covered = ~rejects(mixed.ravel().round(9), counts, 0.0, far, Z)
        setting = {
            "scenes": self.scenes,
            "seeds": first.seeds,
            "cost rate": first.rate,
            "cost lean": first.lean,
            "gain rate": second.rate,
            "alike": first.alike,
            "seed effects": int(first.seed_effects),
        }
        return Measured(BREAK_EVEN, setting, float(times @ covered) / self.runs, self.runs)


@dataclass(frozen=True)
class ModelsCoverage:
    """Coverage of the 95 % interval for newly trained models; the first arm alone ever wins."""

    scenes: int
    seeds: int
    rate: float
    own: bool
    """Whether each training has a rate of its own, from 0 to twice ``rate``."""
    runs: int

    def measure(self) -> Measured:
        """Return the coverage of the mean over all trainings that might have been."""
        stream = generator("selfcheck", repr(self), 0)
        resamples = Resamples.draw("selfcheck", self.scenes, n_resamples=1)
        covered, truth = 0, 100.0 * self.rate
        for _ in range(self.runs):
            rates = self.rate * (stream.uniform(0.0, 2.0, size=self.seeds) if self.own else 1.0)
            together, alike = stream.random((2, self.scenes, 1))
            apart = stream.random((self.scenes, self.seeds))
            wins = np.where(alike < 0.5, together, apart) < rates
            none = np.zeros_like(wins)
            found = success_effect(wins, none, resamples, models=True).interval
            covered += found is not None and found[0] - _SLACK <= truth <= found[1] + _SLACK
        setting = {
            "scenes": self.scenes,
            "seeds": self.seeds,
            "rate": self.rate,
            "own rates": int(self.own),
        }
        return Measured(MODELS, setting, covered / self.runs, self.runs)


def interval_grid(scenes: tuple[int, ...], runs: int) -> Iterator[IntervalCoverage]:
    """Yield the grid of the effect's interval."""
    for n, kind, rate, lean in product(scenes, _structures((0.0, 0.5, 1.0)), RATES, LEANS):
        yield IntervalCoverage(n, Population(rate, lean, *kind), runs)


def break_even_grid(scenes: tuple[int, ...], runs: int) -> Iterator[BreakEvenCoverage]:
    """Yield the grid of the break-even frequency: costs of all sizes, gains of 5 and 30 %."""
    kinds = _structures((0.0, 0.5))
    for n, kind, rate, lean, gain in product(scenes, kinds, RATES, LEANS, (0.05, 0.3)):
        correct = Population(rate, -lean, *kind)
        if correct.mean <= 0.0:
            yield BreakEvenCoverage(n, correct, Population(gain, 1.0, *kind), runs)


def models_grid(runs: int) -> Iterator[ModelsCoverage]:
    """Yield the grid of the interval for newly trained models."""
    for own, n, seeds, rate in product((False, True), (25, 100), (3, 5), RATES[::2]):
        yield ModelsCoverage(n, seeds, rate, own, runs)


def _structures(alike: tuple[float, ...]) -> list[tuple[int, float, bool]]:
    return [(1, 0.0, False), *product((3, 5), alike, (False, True))]


def tables(n: int) -> Floats:
    """Return every table of ``n`` scenes of one seed: second only, neither, first only."""
    first, second = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    fits = first + second <= n
    first, second = first[fits], second[fits]
    return np.stack([second, n - first - second, first], axis=1).astype(np.float64)
