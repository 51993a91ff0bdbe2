"""Populations of scenes whose truth is known: by how much the arms differ in a scene, and why.

A population is the distribution of the sum over seeds of (first minus second), of each scene.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from faultpath.statistics.inputs import Floats

RATES = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5)
SCENES = (10, 25, 50, 100, 300)


@dataclass(frozen=True)
class Population:
    """Scenes of which a share ``rate`` differs in each seed, on average over the seeds.

    ``lean`` is the share of these that favours the first arm less the share that favours the
    second: 0 symmetric, 1 one-sided. With probability ``alike`` a scene treats all seeds alike,
    else each for itself. ``seed_effects``: seeds have other rates (0 to twice ``rate``) and, where
    ``lean`` leaves room, other directions.
    """

    rate: float
    lean: float
    seeds: int = 1
    alike: float = 0.0
    seed_effects: bool = False

    @property
    def mean(self) -> float:
        """Return the true difference, a fraction."""
        first, second = self._rates()
        return round(float((first - second).mean()), 14)

    @property
    def sizes(self) -> Floats:
        """Return the possible differences of a scene, ascending."""
        return np.arange(-self.seeds, self.seeds + 1) / self.seeds

    def chances(self) -> Floats:
        """Return the chance of each of ``sizes``."""
        first, second = self._rates()
        apart = np.ones(1)
        for a, b in zip(first, second, strict=True):
            apart = np.convolve(apart, [b, 1.0 - a - b, a])
        together = np.zeros(2 * self.seeds + 1)
        edges = np.unique(np.concatenate([[0.0, 1.0], first, 1.0 - second]))
        for low, high in pairwise(edges.tolist()):
            draw = 0.5 * (low + high)
            total = int((draw < first).sum()) - int((draw > 1.0 - second).sum())
            together[total + self.seeds] += high - low
        mixed = np.maximum((1.0 - self.alike) * apart + self.alike * together, 0.0)
        return mixed / mixed.sum()

    def outcomes(self, draws: Floats) -> Floats:
        """Return first minus second [scenes, seeds] for uniform ``draws`` [scenes, 1 + seeds + 1].

        The first decides whether the seeds are treated alike; the last serves them then.
        """
        first, second = self._rates()
        alike = draws[:, :1] < self.alike
        own = np.where(alike, draws[:, -1:], draws[:, 1:-1])
        return (own < first).astype(np.float64) - (own > 1.0 - second)

    def _rates(self) -> tuple[Floats, Floats]:
        rate = np.full(self.seeds, self.rate)
        lean = np.full(self.seeds, self.lean)
        if self.seed_effects and self.seeds > 1:
            spread = np.linspace(-1.0, 1.0, self.seeds)
            rate = rate * (1.0 + spread)
            lean = lean + (1.0 - np.abs(lean)) * spread
        return rate * (1.0 + lean) / 2.0, rate * (1.0 - lean) / 2.0


def joint(first: Population, second: Population, together: float) -> Floats:
    """Return the chances [sizes, sizes] of a scene in two conditions.

    With probability ``together`` a scene that is good to one arm in one condition is so in the
    other, else the conditions are independent.
    """
    one, two = first.chances(), second.chances()
    mixed = (1.0 - together) * np.outer(one, two)
    ends_one: Floats = np.cumsum(one)
    ends_two: Floats = np.cumsum(two)
    edges = np.unique(np.concatenate([[0.0], ends_one, ends_two]))
    for low, high in pairwise(edges.tolist()):
        draw = 0.5 * (low + high)
        i = min(int((ends_one < draw).sum()), len(one) - 1)
        j = min(int((ends_two < draw).sum()), len(two) - 1)
        mixed[i, j] += together * (high - low)
    return mixed / mixed.sum()
