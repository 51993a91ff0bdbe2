"""What the statistics keep: populations with a known truth, decided by the shipped code.

`make statistics` writes `docs/statistics-check.md` from it; tests hold a few settings to the
promises. Streams are named after the setting, so the same setting gives the same rate.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.stats import multinomial

from faultpath.analyses.contrasts import Outcomes as Variants
from faultpath.analyses.contrasts import alpha_shares
from faultpath.analyses.family import TestedContrasts, decide_conditions
from faultpath.analyses.model import CORRECT, SHARED
from faultpath.core.streams import generator
from faultpath.stats.estimate import ALPHA
from faultpath.stats.power import detectable, rule_power, significant
from faultpath.stats.score import degrees_interval, degrees_rejects

Floats = NDArray[np.float64]
RATES = (0.005, 0.02, 0.05, 0.1, 0.3, 0.5)
LEANS = {0.0: "even", 0.5: "three to one", 1.0: "one-sided"}
CONDITIONS = (CORRECT, "reconstruction", "predictor", SHARED)


@dataclass(frozen=True)
class Population:
    """Scenes of which a share ``rate`` differs in each seed, on average over the seeds.

    ``lean`` is the share of these that favours the first variant less the share that favours the
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
        """The true difference, a fraction."""
        first, second = self._rates()
        return round(float((first - second).mean()), 14)

    @property
    def sizes(self) -> Floats:
        """The possible differences of a scene, ascending."""
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

    With probability ``together`` a scene that is good to one variant in one condition is so in the
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


def powered(seeds: int, scenes: int = 100, runs: int = 20_000) -> float:
    """Return the power of one or more seeds of which half of the scenes agree, where 5.4 % of the
    trials favour one variant and .6 % the other."""
    truth = Population(0.06, 0.8, seeds, 0.5)
    if seeds == 1:
        return rule_power(scenes, truth.rate, truth.mean)
    stream = generator("statistics", f"power {scenes} {truth}", 0)
    counts = stream.multinomial(scenes, truth.chances(), size=runs).astype(np.float64)
    return float(significant(truth.sizes, counts, ALPHA).mean())


def tables(n: int) -> Floats:
    """Return every table of ``n`` scenes of one seed: second only, neither, first only."""
    first, second = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    fits = first + second <= n
    first, second = first[fits], second[fits]
    return np.stack([second, n - first - second, first], axis=1).astype(np.float64)


def interval_coverage(scenes: int, truth: Population, runs: int = 4000) -> float:
    """Return how often the 95 % interval of an effect covers the truth; exact for one seed."""
    if truth.seeds == 1:
        counts = tables(scenes)
        weight = multinomial(int(counts[0].sum()), truth.chances()).pmf(counts)
    else:
        stream = generator("statistics", f"interval {scenes} {truth}", 0)
        drawn = stream.multinomial(scenes, truth.chances(), size=runs).astype(np.float64)
        counts, times = np.unique(drawn, axis=0, return_counts=True)
        weight = times / runs
    low, high = degrees_interval(truth.sizes, counts, 1.0, 1.0 - ALPHA)
    return float(weight @ ((low <= truth.mean) & (high >= truth.mean)))


def break_even_coverage(
    scenes: int, correct: Population, faulty: Population, runs: int = 2000
) -> float:
    """Return how often the break-even set holds the true frequency: its mixture is not rejected."""
    p = correct.mean / (correct.mean - faulty.mean)
    stream = generator("statistics", f"break-even {scenes} {correct} {faulty}", 0)
    chances = joint(correct, faulty, 0.5).ravel()
    drawn = stream.multinomial(scenes, chances, size=runs).astype(np.float64)
    counts, times = np.unique(drawn, axis=0, return_counts=True)
    mixed = (1.0 - p) * correct.sizes[:, np.newaxis] + p * faulty.sizes
    return float(times @ ~degrees_rejects(mixed.ravel().round(9), counts, 1.0, ALPHA)) / runs


def audit_of(
    stream: np.random.Generator, n: int, conditions: Mapping[str, Population], together: float
) -> dict[str, Variants]:
    """Return paired successes [scenes, seeds] under each condition.

    ``together`` is the chance that a scene is the same under all conditions, as where a fault
    changes nothing.
    """
    seeds = next(iter(conditions.values())).seeds
    common = stream.random((n, seeds + 2))
    found: dict[str, Variants] = {}
    for condition, population in conditions.items():
        same = stream.random((n, 1)) < together
        draws: Floats = np.where(same, common, stream.random((n, seeds + 2)))
        difference = population.outcomes(draws)
        found[condition] = (difference >= 0.0, difference <= 0.0)
    return found


def announces(family: TestedContrasts) -> bool:
    """Return whether anything is detected: an effect, a change, a reversal."""
    return any(each.sign for part in (family.effects, family.changes) for each in part.values())


def equal_variants(scenes: int, truth: Population, together: float, runs: int = 2000) -> float:
    """Return the share of audits of variants that do not differ that announce anything."""
    stream = generator("statistics", f"equal variants {scenes} {truth} {together}", 0)
    conditions = dict.fromkeys(CONDITIONS, truth)
    audits = (audit_of(stream, scenes, conditions, together) for _ in range(runs))
    return sum(announces(decide_conditions(variants)) for variants in audits) / runs


def failing(
    stream: np.random.Generator, variants: Mapping[str, Variants], rates: Mapping[str, float]
) -> dict[str, Variants]:
    """Return successes of which a share of the trials under each condition has no outcome."""
    lost: dict[str, Variants] = {}
    for condition, pair in variants.items():
        one, two = (
            np.where(stream.random(a.shape) < rates.get(condition, 0.0), np.nan, a) for a in pair
        )
        lost[condition] = one, two
    return lost


def reversing(seeds: int, isolated: float) -> dict[str, Population]:
    """Return populations with these isolated effects and a shared one of -20 pp."""
    alone = Population(0.3, isolated / 0.3, seeds, 0.5)
    return {
        CORRECT: Population(0.1, 0.0, seeds, 0.5),
        "reconstruction": alone,
        "predictor": alone,
        SHARED: Population(0.3, -2.0 / 3.0, seeds, 0.5),
    }


def reversals(
    scenes: int, seeds: int, isolated: float, failed: float = 0.0, runs: int = 600
) -> float:
    """Return the share of audits that announce a reversal: isolated effects as stated, shared
    -20 pp, and a share of all trials failed."""
    stream = generator("statistics", f"reversals {scenes} {seeds} {isolated}", 0)
    conditions = reversing(seeds, isolated)
    announced = 0
    for _ in range(runs):
        variants = audit_of(stream, scenes, conditions, 0.3)
        if failed:
            variants = failing(stream, variants, dict.fromkeys(conditions, failed))
        family = decide_conditions(variants)
        announced += "reversal" in family.turns.values()
    return announced / runs


def beside_failures(failed: float, runs: int = 600) -> float:
    """Return the power of an isolated effect of 20 pp, 60 scenes and three seeds, where a share of
    the trials under the shared fault failed, which has no effect."""
    stream = generator("statistics", "beside failures", 0)
    none = Population(0.1, 0.0, 3, 0.5)
    conditions = {CORRECT: none, "reconstruction": Population(0.3, 0.4, 3, 0.5), SHARED: none}
    significant = 0
    for _ in range(runs):
        variants = audit_of(stream, 60, conditions, 0.3)
        family = decide_conditions(failing(stream, variants, {SHARED: failed}))
        significant += family.effects["reconstruction"].sign == 1
    return significant / runs


def trainings(
    scenes: int, seeds: int, models: bool, collapse: float = 0.0, runs: int = 2000
) -> float:
    """Return how often two equal methods, 8 pp between one training and the next, are told apart.

    ``models``: whether the audit speaks of newly trained models. With ``collapse`` one training in
    ten loses so many pp instead, and the others gain what makes up for it.
    """
    stream = generator("statistics", f"trainings {scenes} {seeds} {models}", 0)
    announced = 0
    for _ in range(runs):
        shift = stream.normal(0.0, 0.08, size=seeds)
        if collapse:
            shift = np.where(stream.random(seeds) < 0.1, -collapse, collapse / 9.0)
        easy = stream.random((scenes, 1))
        noise = stream.normal(0.0, 0.15, size=(2, scenes, seeds))
        variants = (easy + noise[0] < 0.5 + shift, easy + noise[1] < 0.5)
        announced += announces(decide_conditions({CORRECT: variants}, models=models))
    return announced / runs


def alike(scenes: int, seeds: int, runs: int = 1000) -> float:
    """Return how often something is reported of equal methods under four conditions, of which all
    trainings succeed in nearly the same scenes: six contrasts."""
    stream = generator("statistics", f"alike {scenes} {seeds}", 0)
    announced = 0
    for _ in range(runs):
        variants = {
            condition: tuple(
                stream.normal(0.0, 0.15, (2, scenes, 1))
                + stream.normal(0.0, 0.02, (2, scenes, seeds))
                < 0.0
            )
            for condition in CONDITIONS
        }
        announced += announces(decide_conditions(variants, models=True))
    return announced / runs


def detection(scenes: int, truth: Population, alpha: float, runs: int = 20) -> float:
    """Return how often a true difference is detected that audits of equal variants reported as the
    least detectable one, averaged over ``runs`` reports."""
    stream = generator("statistics", f"detection {scenes} {truth} {alpha}", 0)
    shares: list[float] = []
    for _ in range(runs):
        difference = truth.outcomes(stream.random((scenes, truth.seeds + 2)))
        least = detectable(difference, alpha=alpha)
        if least is None:
            continue
        rate = max(truth.rate, least / 100.0)
        true = replace(truth, rate=rate, lean=min(1.0, least / 100.0 / rate))
        if truth.seeds == 1:
            shares.append(rule_power(scenes, rate, least / 100.0, alpha))
            continue
        counts = stream.multinomial(scenes, true.chances(), size=400).astype(np.float64)
        shares.append(float(significant(true.sizes, counts, alpha).mean()))
    return float(np.mean(shares))


def any_look(scenes: int, truth: Population, together: float, runs: int = 150) -> float:
    """Return the share of sequential audits of equal variants that announce anything at any of ten
    looks."""
    stream = generator("statistics", f"looks {scenes} {truth} {together}", 0)
    looks = np.unique(np.linspace(0, scenes, 11, dtype=np.int64)[1:]).tolist()
    shares = alpha_shares(CONDITIONS, SHARED)
    announced = 0
    for _ in range(runs):
        variants = audit_of(stream, scenes, dict.fromkeys(CONDITIONS, truth), together)
        announced += any(
            announces(
                decide_conditions(
                    {
                        condition: (one[:look], two[:look])
                        for condition, (one, two) in variants.items()
                    },
                    primary=SHARED,
                    shares=shares,
                )
            )
            for look in looks
        )
    return announced / runs


def kept(rate: float, runs: int, least: float = 0.0, most: float = 1.0) -> bool:
    """Return whether a rate lies within limits, or beyond by at most three standard errors.

    ``runs`` is 0 for a rate that is exact.
    """
    below, above = (3.0 * sqrt(p * (1.0 - p) / runs) if runs else 0.0 for p in (least, most))
    return least - below <= rate <= most + above
