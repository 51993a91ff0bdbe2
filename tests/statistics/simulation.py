"""What the statistics keep: populations with a known truth, decided by the shipped code.

`make statistics` writes `docs/statistics-check.md` from it; tests hold a few settings to the
promises. Streams are named after the setting, so the same setting gives the same rate.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise, product
from math import sqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.stats import multinomial

from faultpath.record.family import ALPHA, CORRECT, SHARED, Arms, alpha_shares, decide_paths
from faultpath.statistics import IN_FORCE, Resamples, detectable, success_effect
from faultpath.statistics.betting import log_capitals
from faultpath.statistics.power import detected
from faultpath.statistics.rules import RULES
from faultpath.statistics.score import quantile, reach, rejects
from faultpath.streams import generator

Floats = NDArray[np.float64]
Z = quantile(0.95)
PRIOR = RULES[IN_FORCE].prior
RATES = (0.005, 0.02, 0.05, 0.1, 0.3, 0.5)
LEANS = {0.0: "even", 0.5: "three to one", 1.0: "one-sided"}
PATHS = (CORRECT, "reconstruction", "predictor", SHARED)


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
    far = reach(truth.sizes, counts, 1.0, PRIOR)
    return float(weight @ ~rejects(truth.sizes, counts, truth.mean, far, Z))


def break_even_coverage(
    scenes: int, correct: Population, faulty: Population, runs: int = 2000
) -> float:
    """Return how often the break-even set holds the true frequency: its mixture is not rejected."""
    p = correct.mean / (correct.mean - faulty.mean)
    kinds = len(correct.sizes)
    stream = generator("statistics", f"break-even {scenes} {correct} {faulty}", 0)
    chances = joint(correct, faulty, 0.5).ravel()
    drawn = stream.multinomial(scenes, chances, size=runs).astype(np.float64)
    counts, times = np.unique(drawn, axis=0, return_counts=True)
    square = counts.reshape(-1, kinds, kinds)
    far_0 = reach(correct.sizes, square.sum(axis=2), 1.0, PRIOR)
    far_f = reach(faulty.sizes, square.sum(axis=1), 1.0, PRIOR)
    mixed = (1.0 - p) * correct.sizes[:, np.newaxis] + p * faulty.sizes
    far = (1.0 - p) * far_0 + p * far_f
    return float(times @ ~rejects(mixed.ravel().round(9), counts, 0.0, far, Z)) / runs


def audit_of(
    stream: np.random.Generator, n: int, paths: Mapping[str, Population], together: float
) -> dict[str, Arms]:
    """Return paired successes [scenes, seeds] on each path.

    ``together`` is the chance that a scene is the same on all paths, as where a fault changes
    nothing.
    """
    seeds = next(iter(paths.values())).seeds
    common = stream.random((n, seeds + 2))
    found: dict[str, Arms] = {}
    for path, population in paths.items():
        same = stream.random((n, 1)) < together
        draws: Floats = np.where(same, common, stream.random((n, seeds + 2)))
        difference = population.outcomes(draws)
        found[path] = (difference >= 0.0, difference <= 0.0)
    return found


def equal_arms(scenes: int, truth: Population, together: float, runs: int = 300) -> float:
    """Return the share of audits of arms that do not differ that announce anything."""
    stream = generator("statistics", f"equal arms {scenes} {truth} {together}", 0)
    paths = dict.fromkeys(PATHS, truth)
    audits = (audit_of(stream, scenes, paths, together) for _ in range(runs))
    return sum(decide_paths(arms, rule=IN_FORCE).announces for arms in audits) / runs


def reversals(scenes: int, seeds: int, isolated: float, runs: int = 600) -> float:
    """Return the share of audits that announce a reversal: isolated effects as stated, shared
    -20 pp."""
    stream = generator("statistics", f"reversals {scenes} {seeds} {isolated}", 0)
    alone = Population(0.3, isolated / 0.3, seeds, 0.5)
    paths = {
        CORRECT: Population(0.1, 0.0, seeds, 0.5),
        "reconstruction": alone,
        "predictor": alone,
        SHARED: Population(0.3, -2.0 / 3.0, seeds, 0.5),
    }
    announced = 0
    for _ in range(runs):
        family = decide_paths(audit_of(stream, scenes, paths, 0.3), rule=IN_FORCE)
        announced += "reversal" in family.turns.values()
    return announced / runs


def trainings(scenes: int, seeds: int, models: bool, runs: int = 2000) -> float:
    """Return how often two equal methods, 8 pp between one training and the next, are told apart.

    ``models``: whether the audit speaks of newly trained models.
    """
    stream = generator("statistics", f"trainings {scenes} {seeds} {models}", 0)
    resamples = Resamples.draw("statistics", scenes, n_resamples=1)
    announced = 0
    for _ in range(runs):
        shift = stream.normal(0.0, 0.08, size=seeds)
        easy = stream.random((scenes, 1))
        noise = stream.normal(0.0, 0.15, size=(2, scenes, seeds))
        arms = (easy + noise[0] < 0.5 + shift, easy + noise[1] < 0.5)
        family = decide_paths({CORRECT: arms}, rule=IN_FORCE, resamples=resamples, models=models)
        announced += family.announces
    return announced / runs


def models_coverage(scenes: int, seeds: int, rate: float, runs: int = 400) -> float:
    """Return how often the interval for newly trained models, all alike, covers the truth."""
    stream = generator("statistics", f"models {scenes} {seeds} {rate}", 0)
    resamples = Resamples.draw("statistics", scenes, n_resamples=1)
    covered, truth = 0, 100.0 * rate
    for _ in range(runs):
        together, alike = stream.random((2, scenes, 1))
        apart = stream.random((scenes, seeds))
        wins = np.where(alike < 0.5, together, apart) < rate
        found = success_effect(wins, np.zeros_like(wins), resamples, models=True).interval
        covered += found is not None and found[0] - 1e-9 <= truth <= found[1] + 1e-9
    return covered / runs


def detection(scenes: int, truth: Population, alpha: float, runs: int = 20) -> float:
    """Return how often a true difference is detected that audits of equal arms reported as the
    least detectable one, averaged over ``runs`` reports."""
    stream = generator("statistics", f"detection {scenes} {truth} {alpha}", 0)
    shares: list[float] = []
    for _ in range(runs):
        difference = truth.outcomes(stream.random((scenes, truth.seeds + 2)))
        least = detectable(difference > 0.0, difference < 0.0, rule=IN_FORCE, alpha=alpha)
        if least is None:
            continue
        rate = max(truth.rate, least / 100.0)
        true = replace(truth, rate=rate, lean=min(1.0, least / 100.0 / rate))
        counts = stream.multinomial(scenes, true.chances(), size=400).astype(np.float64)
        far = reach(true.sizes, counts, 1.0, PRIOR)
        shares.append(float(detected(true.sizes, counts, far, alpha, IN_FORCE).mean()))
    return float(np.mean(shares))


def any_look(scenes: int, truth: Population, together: float, runs: int = 150) -> float:
    """Return the share of sequential audits of equal arms that announce anything at any of ten
    looks."""
    stream = generator("statistics", f"looks {scenes} {truth} {together}", 0)
    looks = np.unique(np.linspace(0, scenes, 11, dtype=np.int64)[1:]).tolist()
    shares = alpha_shares(PATHS, SHARED)
    announced = 0
    for _ in range(runs):
        arms = audit_of(stream, scenes, dict.fromkeys(PATHS, truth), together)
        announced += any(
            decide_paths(
                {path: (one[:look], two[:look]) for path, (one, two) in arms.items()},
                rule=IN_FORCE,
                primary=SHARED,
                shares=shares,
            ).announces
            for look in looks
        )
    return announced / runs


def every_look(scenes: int, truth: Population, runs: int = 300) -> float:
    """Return how often the confidence sequence holds the truth after every scene."""
    stream = generator("statistics", f"every look {scenes} {truth}", 0)
    needed = np.log(2.0 / ALPHA)
    missed = 0
    for _ in range(runs):
        values = truth.outcomes(stream.random((scenes, truth.seeds + 2))).mean(axis=1)
        capitals = (log_capitals(side * values, side * truth.mean, 1.0) for side in (1, -1))
        missed += any(bool((capital >= needed).any()) for capital in capitals)
    return 1.0 - missed / runs


def kept(rate: float, runs: int, least: float = 0.0, most: float = 1.0) -> bool:
    """Return whether a rate lies within limits, or beyond by at most three standard errors.

    ``runs`` is 0 for a rate that is exact.
    """
    below, above = (3.0 * sqrt(p * (1.0 - p) / runs) if runs else 0.0 for p in (least, most))
    return least - below <= rate <= most + above


def share(rates: Iterable[float]) -> str:
    """Return `.950`, or the least and the greatest of several rates."""
    texts = [f"{r:.3f}".removeprefix("0") if r < 0.9995 else "1" for r in sorted(rates)]
    return texts[0] if texts[0] == texts[-1] else f"{texts[0]}–{texts[-1]}"


def markdown(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table."""
    lines = [list(heads), *map(list, rows)]
    lines.insert(1, [":--", *["--:"] * (len(lines[0]) - 1)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def sections() -> Iterator[tuple[str, str, str]]:
    """Yield title, note and table of everything that is measured."""
    by_rate = [f"{100 * rate:g} %" for rate in RATES]
    kinds = [(seeds, alike, own) for seeds in (3, 5) for alike in (0.0, 0.5) for own in (0, 1)]

    def structured(rate: float, lean: float, seeds: int) -> list[Population]:
        mine = [each for each in kinds if each[0] == seeds] or [(1, 0.0, 0)]
        return [Population(rate, lean, n, alike, bool(own)) for n, alike, own in mine]

    yield (
        "Interval of an effect",
        "Least and greatest coverage of the 95 % interval, over even and one-sided splits of the "
        "scenes that differ, and over seeds that are independent or half alike, without and with "
        "seed effects; exact for one seed. Columns: share of scenes that differ. Promised: at "
        "least .93. Where few scenes differ no interval of counts can keep .95: it covers more.",
        markdown(
            ("scenes, seeds", *by_rate),
            (
                (
                    f"{n}, {seeds}",
                    *(
                        share(
                            interval_coverage(n, truth)
                            for lean in LEANS
                            for truth in structured(rate, lean, seeds)
                        )
                        for rate in RATES
                    ),
                )
                for n, seeds in product((10, 25, 50, 100, 300), (1, 3, 5))
            ),
        ),
    )
    yield (
        "Break-even frequency",
        "Least and greatest coverage of the set of frequencies at which it is not decided who is "
        "ahead, over costs that are one-sided or in between and gains of 5 and 30 pp under the "
        "fault. Columns: share of scenes that differ under correct inputs. Promised: at least .93.",
        markdown(
            ("scenes, seeds", *by_rate),
            (
                (
                    f"{n}, {seeds}",
                    *(
                        share(
                            break_even_coverage(n, cost, replace(cost, rate=gain, lean=1.0))
                            for lean, gain in product((0.5, 1.0), (0.05, 0.3))
                            for cost in structured(rate, -lean, seeds)
                            if cost.mean <= 0.0
                        )
                        for rate in RATES
                    ),
                )
                for n, seeds in product((25, 100, 300), (1, 3))
            ),
        ),
    )
    yield (
        "Interval for newly trained models",
        "Coverage of the interval of `--generalise models`, where only the first arm ever wins. "
        "Columns: share of scenes that differ. Promised: at least .93.",
        markdown(
            ("scenes, trainings", *by_rate),
            (
                (f"{n}, {seeds}", *(share([models_coverage(n, seeds, rate)]) for rate in RATES))
                for n, seeds in product((25, 100), (3, 5))
            ),
        ),
    )
    yield (
        "Least detectable difference",
        "Audits of equal arms report what they could have detected; then the true difference is "
        "made that. Share of audits that detect it. Promised: about .80, at least .70.",
        markdown(
            ("scenes, share that differs", "1 seed", "3 seeds"),
            (
                (
                    f"{n}, {100 * rate:g} %",
                    *(
                        share([detection(n, Population(rate, 0.0, s, 0.5 * (s > 1)), ALPHA)])
                        for s in (1, 3)
                    ),
                )
                for n, rate in product((25, 100, 300), (0.02, 0.1, 0.3))
            ),
        ),
    )
    sizes = ((25, 1), (100, 1), (100, 3))
    for title, what, found in (
        ("Audits of equal arms", "four paths", equal_arms),
        ("Sequential audits of equal arms", "four paths and ten looks", any_look),
    ):
        yield (
            title,
            f"Share of audits with {what} that announce anything at all. Paths alike: chance that "
            "a scene ends the same on all paths. Promised: at most .05.",
            markdown(
                ("scenes, seeds, share that differs", "paths independent", "paths alike 70 %"),
                (
                    (
                        f"{n}, {seeds}, {100 * rate:g} %",
                        *(
                            share([found(n, Population(rate, 0.0, seeds, 0.5), t)])
                            for t in (0, 0.7)
                        ),
                    )
                    for (n, seeds), rate in product(sizes, (0.05, 0.3))
                ),
            ),
        )
    yield (
        "Reversals",
        "Share of audits that announce a reversal where the shared effect is -20 pp. Where both "
        "isolated effects are 0 there is none; promised: at most .015. The others show the power.",
        markdown(
            ("scenes, seeds", "isolated effects 0", "isolated effects 20 pp"),
            (
                (f"{n}, {s}", *(share([reversals(n, s, pp)]) for pp in (0.0, 0.2)))
                for n, s in product((25, 100), (1, 3))
            ),
        ),
    )
    yield (
        "Equal methods, other trainings",
        "Two equal methods, of which every training is off by 8 pp (standard deviation). Share of "
        "audits that detect a difference. For newly trained models that is an error, promised in "
        "at most .05; for these trained models it is not one: they do differ.",
        markdown(
            ("scenes, trainings", "new trainings", "these trainings"),
            (
                (f"100, {s}", *(share([trainings(100, s, m)]) for m in (True, False)))
                for s in (2, 3, 5)
            ),
        ),
    )
    yield (
        "Confidence sequence of an effect",
        "Share of sequential audits whose 95 % confidence sequence holds the truth after every one "
        "of 300 scenes. Columns: share of scenes that differ. Promised: at least .95.",
        markdown(
            ("seeds, split", *by_rate),
            (
                (
                    f"{s}, {words}",
                    *(
                        share([every_look(300, Population(r, lean, s, 0.5 * (s > 1)))])
                        for r in RATES
                    ),
                )
                for s, (lean, words) in product((1, 3), LEANS.items())
            ),
        ),
    )


def main() -> None:
    """Write the page; its path is the argument."""
    lines = [
        "# What the statistics keep",
        "",
        "Made by `make statistics`. Populations with a known truth are sampled, and the shipped "
        "code decides. Simulated rates have a standard error of .003 (interval), .005 "
        "(break-even), .011 (newly trained models), at most .013 (audits) and .018 (sequential "
        "audits). What is promised, and how it is decided: "
        "[design/statistics.md](design/statistics.md).",
        "",
    ]
    for title, note, table in sections():
        print(title, file=sys.stderr, flush=True)
        lines += [f"## {title}", "", note, "", table, ""]
    Path(sys.argv[1]).write_text("\n".join(lines).rstrip() + "\n", "utf-8")


if __name__ == "__main__":
    main()
