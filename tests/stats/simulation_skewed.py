"""Populations that differ otherwise to one side than to the other: many by little, few by much."""

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from faultpath.core.streams import generator
from faultpath.stats.estimate import ALPHA
from faultpath.stats.power import significant
from faultpath.stats.score import degrees_interval

Floats = NDArray[np.float64]


class Skewed(NamedTuple):
    """Scenes of which neither variant is ahead, and that differ otherwise to one side than to the
    other: many by little, few by much."""

    scenes: int
    seeds: int
    chances: Floats
    """Chance of each of the possible differences, ascending."""

    @classmethod
    def drawn(cls, stream: np.random.Generator) -> "Skewed":
        """Draw one."""
        scenes, seeds = int(stream.choice([25, 50, 100, 300])), int(stream.choice([2, 3, 5]))
        sizes = np.arange(1, seeds + 1) / seeds
        won, lost = (
            stream.dirichlet(np.full(seeds, stream.choice([0.15, 0.5, 2.0]))) for _ in range(2)
        )
        differ = float(np.exp(stream.uniform(np.log(0.01), np.log(0.8))))
        wins = differ * float(lost @ sizes) / float((won + lost) @ sizes)
        parts = ((differ - wins) * lost[::-1], [1.0 - differ], wins * won)
        return cls(scenes, seeds, np.concatenate(parts))

    @classmethod
    def even(cls, scenes: int, seeds: int, lost: float, parts: int, noise: float) -> "Skewed":
        """Return one in which a share of scenes loses all seeds and so many gain ``parts`` of them
        that neither version is ahead; ``noise`` of them differ by one seed besides."""
        chances = np.zeros(2 * seeds + 1)
        chances[0] = lost
        chances[seeds + parts] = lost * seeds / parts
        chances[[seeds - 1, seeds + 1]] += noise / 2.0
        chances[seeds] += 1.0 - chances.sum()
        return cls(scenes, seeds, chances)

    def announced(self, runs: int, stream: np.random.Generator) -> tuple[float, float]:
        """Return how often an audit of one condition announces a difference, and how often the
        version that is so more often: where a fault at one module certainly favours the other, as
        often is a reversal false."""
        counts = stream.multinomial(self.scenes, self.chances, size=runs).astype(np.float64)
        values = np.arange(-self.seeds, self.seeds + 1) / self.seeds
        counts, times = np.unique(counts, axis=0, return_counts=True)
        found = times * significant(values, counts, ALPHA)
        first = float(found[counts @ values > 0.0].sum()) / runs
        both = float(found.sum()) / runs
        return both, max(first, both - first)


def skewed(
    populations: int, runs: int = 2000, again: int = 40_000
) -> tuple[float, float, float, float]:
    """Return the largest shares of audits that announce a difference, and one side of it, among so
    many populations without one and a grid of even ones, and the shares of populations in which
    these are above 5 and 2.5 %.

    Those in which one seems to be are looked at ``again``, so that the largest is not noise.
    """
    stream = generator("statistics", f"skewed {populations}", 0)
    above = list[tuple[float, float]]()
    grid = [
        Skewed.even(*size, lost, parts, noise)
        for size in product((25, 50, 100, 300), (3, 5))
        for lost, parts, noise in product((0.005, 0.01, 0.02, 0.05), (1, 2), (0.0, 0.3))
        if lost * size[1] / parts + lost + noise <= 1.0
    ]
    drawn = [Skewed.drawn(stream) for _ in range(populations)]
    for population in (*drawn, *grid):
        either, one = population.announced(runs, stream)
        if either > ALPHA or one > ALPHA / 2.0:
            above.append(population.announced(again, stream))
    count = len(drawn) + len(grid)
    largest = [max((rates[k] for rates in above), default=0.0) for k in (0, 1)]
    often = [sum(rates[k] > ALPHA / (1 + k) for rates in above) / count for k in (0, 1)]
    return largest[0], largest[1], often[0], often[1]


def skewed_coverage(
    scenes: int, seeds: int, gains: float, lost: float, runs: int = 10_000
) -> float:
    """Return how often the interval covers the truth where a share of scenes gains one seed and a
    few lose all."""
    stream = generator("statistics", f"skewed coverage {scenes} {seeds} {gains} {lost}", 0)
    values = np.arange(-seeds, seeds + 1) / seeds
    chances = np.zeros(len(values))
    chances[[0, seeds + 1]] = lost, gains * (1.0 - lost)
    chances[seeds] = 1.0 - chances.sum()
    drawn = stream.multinomial(scenes, chances, size=runs).astype(np.float64)
    counts, times = np.unique(drawn, axis=0, return_counts=True)
    low, high = degrees_interval(values, counts, 1.0, 1.0 - ALPHA)
    truth = float(chances @ values)
    return float(times @ ((low <= truth) & (high >= truth))) / runs
