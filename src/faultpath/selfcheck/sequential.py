"""What sequential audits announce, by the code that decides, and how many scenes they take."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from faultpath.record.family import ALPHA, SHARED, alpha_shares, decide_paths
from faultpath.selfcheck.audits import PATHS, audit_of
from faultpath.selfcheck.model import Measured, Setting
from faultpath.selfcheck.populations import Population
from faultpath.statistics import IN_FORCE
from faultpath.statistics.betting import log_capitals
from faultpath.statistics.inputs import Floats
from faultpath.statistics.power import rule_power
from faultpath.streams import generator

ANY_LOOK, EVERY_LOOK = "sequential, equal arms", "sequential, coverage"
AT_ODDS = "sequential, p against interval"
TAKEN, DECIDED = "sequential, scenes taken", "sequential, decided"
LOOKS = 10
"""Of the audits whose decisions are simulated; a confidence sequence is looked at every scene."""
POWER = 0.9
"""At which the fixed number of scenes is planned that a sequential audit is compared with."""
Bools = NDArray[np.bool_]


def against(values: Floats, mean: float, bound: float, alpha: float) -> Bools:
    """Return [..., scenes]: whether after each scene a mean is doubted at ``alpha``, two-sided."""
    sides = above(values, mean, alpha, bound), above(-values, -mean, alpha, bound)
    return np.logical_or(*sides)


def above(values: Floats, mean: float, alpha: float, bound: float = 1.0) -> Bools:
    """Return [..., scenes]: whether after each scene the truth is known to lie above a mean."""
    needed = np.log(2.0 / alpha)
    return np.asarray(log_capitals(values, mean, bound) >= needed, dtype=np.bool_)


@dataclass(frozen=True)
class AnyLook:
    """Sequential audits with four paths of arms that do not differ."""

    scenes: int
    population: Population
    together: float
    """Chance that a scene is the same on all paths, as where the fault changes nothing."""
    runs: int

    def measure(self) -> tuple[Measured, ...]:
        """Return the share of audits that announce anything at any of `LOOKS` looks, and the share
        in which the primary contrast's p and its interval say otherwise of 0 at any of them."""
        stream = generator("selfcheck", repr(self), 0)
        n, seeds = self.scenes, self.population.seeds
        paths: dict[str, Population] = dict.fromkeys(PATHS, self.population)
        shares = alpha_shares(PATHS, SHARED)
        looks = np.unique(np.linspace(0, n, LOOKS + 1, dtype=np.int64)[1:]).tolist()
        announced = {ANY_LOOK: 0, AT_ODDS: 0}
        for _ in range(self.runs):
            arms = audit_of(stream, n, paths, self.together)
            found = [
                decide_paths(
                    {path: (one[:look], two[:look]) for path, (one, two) in arms.items()},
                    rule=IN_FORCE,
                    primary=SHARED,
                    shares=shares,
                )
                for look in looks
            ]
            announced[ANY_LOOK] += any(family.announces for family in found)
            primary = [family.effects[SHARED] for family in found]
            announced[AT_ODDS] += any(each.rejected != each.side for each in primary)
        setting = {
            "scenes": n,
            "seeds": seeds,
            "rate": self.population.rate,
            "paths alike": self.together,
        }
        return tuple(
            Measured(section, setting, count / self.runs, self.runs)
            for section, count in announced.items()
        )


@dataclass(frozen=True)
class EveryLook:
    """The confidence sequence of an effect, looked at after every scene."""

    scenes: int
    population: Population
    runs: int

    def measure(self) -> Measured:
        """Return the share of audits in which it holds the truth at every look.

        At the look at which an audit stops it then does at least as often, whatever it stops for.
        """
        stream = generator("selfcheck", repr(self), 0)
        truth = self.population
        missed = sum(
            bool(against(_drawn(stream, truth, self.scenes), truth.mean, 1.0, ALPHA).any())
            for _ in range(self.runs)
        )
        setting = {
            "scenes": self.scenes,
            "seeds": truth.seeds,
            "rate": truth.rate,
            "lean": truth.lean,
            "alike": truth.alike,
        }
        return Measured(EVERY_LOOK, setting, 1.0 - missed / self.runs, self.runs)


@dataclass(frozen=True)
class Taken:
    """Sequential audits of six contrasts whose primary one is a true difference, one seed.

    They may take as many scenes as one with a fixed number needs to detect it with `POWER`.
    """

    rate: float
    difference: float
    runs: int
    decided: bool
    """Whether to measure how many decide, rather than how many scenes they take."""

    def measure(self) -> Measured:
        """Return the share of audits that decide, or the mean share of the scenes they take."""
        most = fixed_scenes(self.rate, self.difference)
        stream = generator("selfcheck", f"taken {self.rate} {self.difference}", 0)
        truth = Population(self.rate, self.difference / self.rate)
        alpha = ALPHA * alpha_shares(PATHS, SHARED)[f"effect/{SHARED}"]
        taken, decided = 0, 0
        for _ in range(self.runs):
            found = against(_drawn(stream, truth, most), 0.0, 1.0, alpha)
            decided += bool(found.any())
            taken += int(found.argmax()) + 1 if found.any() else most
        setting: Setting = {
            "rate": self.rate,
            "difference pp": round(100 * self.difference, 1),
            "fixed scenes": most,
        }
        if self.decided:
            return Measured(DECIDED, setting, decided / self.runs, self.runs)
        return Measured(TAKEN, setting, taken / most / self.runs, self.runs)


@cache
def fixed_scenes(rate: float, difference: float) -> int:
    """Return how many scenes detect a primary difference with `POWER`, were their number fixed."""
    alpha = ALPHA * alpha_shares(PATHS, SHARED)[f"effect/{SHARED}"]
    few, many = 0, 10
    while rule_power(many, rate, difference, alpha, rule=IN_FORCE) < POWER:
        few, many = many, 2 * many
    while many - few > 1:
        middle = (few + many) // 2
        reached = rule_power(middle, rate, difference, alpha, rule=IN_FORCE) >= POWER
        few, many = (few, middle) if reached else (middle, many)
    return many


def _drawn(stream: np.random.Generator, truth: Population, scenes: int) -> Floats:
    return truth.outcomes(stream.random((scenes, truth.seeds + 2))).mean(axis=1)


def any_look_grid(runs: int) -> Iterator[AnyLook]:
    """Yield sequential audits of equal arms."""
    sizes = ((25, 1), (100, 1), (300, 1), (100, 3))
    for (n, seeds), rate, together in product(sizes, (0.05, 0.3), (0.0, 0.7)):
        yield AnyLook(n, Population(rate, 0.0, seeds, 0.5), together, runs)


def every_look_grid(runs: int) -> Iterator[EveryLook]:
    """Yield populations for the confidence sequence."""
    for seeds, rate, lean in product((1, 3), (0.02, 0.1, 0.3, 0.6), (0.0, 0.5, 1.0)):
        yield EveryLook(300, Population(rate, lean, seeds, 0.5 if seeds > 1 else 0.0), runs)


def taken_grid(runs: int) -> Iterator[Taken]:
    """Yield true differences, from small and noisy to large."""
    sizes = ((0.2, 0.1), (0.4, 0.1), (0.2, 0.2), (0.4, 0.2), (0.4, 0.3), (0.5, 0.5), (0.7, 0.5))
    for decided, (rate, difference) in product((False, True), sizes):
        yield Taken(rate, difference, runs, decided)
