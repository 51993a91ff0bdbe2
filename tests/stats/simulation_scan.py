"""Scans of systems whose errors are known to cancel or not, in both stages as `scan` runs them.

A trial succeeds where the ability of its scene and chance, equal parts of the variance, exceed what
the errors add to the difficulty. So the conditions of a scene are alike, as they are on common
scenes. A signed error is a number: two signs a reader, two readers a source.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from simulation_tables import Section, markdown, share

from faultpath.core.streams import generator
from faultpath.stats.cancelling import Cancelling, Key, cancelling, stage_one

Floats = NDArray[np.float64]
FIRST, RUNS = 50, 800
"""Scenes of the first stage, and scans of a population."""
BASES = (0.6, 0.95)
"""Success without an error."""
ERRORS = (4, 8, 12)
"""Signed errors."""
SECOND = (50, 200)
"""Scenes of the second stage."""
CLAIMS = ("cancels", "covers")
"""What scans report falsely: that a pair cancels, and that an error covers for another one."""
TRIALS, OTHERS = (4000, 6000, 8000), (0.0, 0.05, 0.1, 0.15)
"""Of scans with a planted pair: trials of both stages, and what the other errors cost."""
TRUTHS = {
    "none": "no effects",
    "add": "harms add up",
    "help": "errors of half of the readers help; all add up",
    "floor": "each error leaves 1 % success",
    "dominate": "the worse of two errors dominates",
    "equal": "the same, errors of equal cost",
}
PLANTED = (0, 5)
"""Errors that cancel: of two sources."""


@dataclass(frozen=True, eq=False)
class Scanned:
    """A system with known errors."""

    base: float
    costs: Floats
    """[errors]: what each adds to the difficulty."""
    dominates: bool = False
    """Whether of two errors the worse one alone counts; otherwise they add up."""
    planted: float | None = None
    """What the planted pair adds to it."""
    seeds: int = 1

    @classmethod
    def of(cls, truth: str, base: float, errors: int, seeds: int = 1) -> "Scanned":
        """Return one of `TRUTHS`; costs are 10 to 30 points, equal ones 20."""
        points = {
            "none": np.zeros(errors),
            "floor": np.full(errors, base - 0.01),
            "equal": np.full(errors, 0.2),
        }
        costs = difficulty(base, points.get(truth, np.linspace(0.1, 0.3, errors)))
        if truth == "help":
            costs = np.where(np.arange(errors) // 2 % 2, -0.5, costs)
        return cls(base, costs, truth in ("dominate", "equal"), seeds=seeds)

    @classmethod
    def with_pair(cls, base: float, others: float, errors: int = 38) -> "Scanned":
        """Return one in which two errors cost 30 points, both 3, and the ``others`` add up."""
        points = np.full(errors, float(others))
        points[list(PLANTED)] = 0.3
        return cls(base, difficulty(base, points), planted=float(difficulty(base, 0.03)))

    def second_stage(self, chosen: tuple[int, ...]) -> tuple[list[int], list[Key], int]:
        """Return errors and pairs of the second stage, and how many conditions it runs."""
        readers = {error: error ^ 2 for error in range(len(self.costs))}  # the source's other one
        partners = {error: readers[error] for error in chosen if readers[error] in readers}
        singles = list(dict.fromkeys((*chosen, *partners.values())))
        pairs = [
            (a, b)
            for a, b in combinations(sorted(chosen), 2)
            if a // 2 != b // 2 and (a // 4 != b // 4 or a % 2 == b % 2)
        ]
        pairs += [(min(e, other), max(e, other)) for e, other in partners.items()]
        pairs = list(dict.fromkeys(pairs))
        sources = {(e, other) for e, other in readers.items() if e < other < len(readers)}
        return singles, pairs, 1 + len(singles) + len(sources.union(pairs))

    def scan(self, stream: np.random.Generator, scenes: int = 0, trials: int = 0) -> Cancelling:
        """Return the result of a scan, of so many other scenes or of all that ``trials`` allow."""
        first = self.outcomes([0.0, *self.costs], FIRST, stream)
        chosen = stage_one(first[0], first[1:]).hurting
        singles, pairs, conditions = self.second_stage(chosen)
        if not singles:
            return Cancelling({}, {})
        scenes = scenes or (trials - first.shape[0] * FIRST) // conditions
        added = [0.0, *self.costs[singles], *map(self.together, pairs)]
        none, *others = self.outcomes(added, scenes, stream)
        alone = dict(zip(singles, others[: len(singles)], strict=True))
        both = dict(zip(pairs, others[len(singles) :], strict=True))
        return cancelling(none, alone, both, {(a, b) for a, b in pairs if a // 4 == b // 4})

    def together(self, pair: Key) -> float:
        """Return what both errors of a pair add to the difficulty."""
        if self.planted is not None and pair == PLANTED:
            return self.planted
        costs = self.costs[list(pair)]
        return float(costs.max() if self.dominates else costs.sum())

    def outcomes(self, added: list[float], scenes: int, stream: np.random.Generator) -> Floats:
        """Return success [conditions, scenes] under what is ``added`` to the difficulty."""
        ability = stream.standard_normal((scenes, 1))
        chance = stream.standard_normal((len(added), scenes, self.seeds))
        limit = np.sqrt(2.0) * (ndtri(self.base) - np.array(added))
        return np.asarray((ability + chance < limit[:, np.newaxis, np.newaxis]).mean(axis=-1))


def difficulty(base: float, points: Floats | float) -> Floats:
    """Return what is to be added to the difficulty for success to fall by ``points``."""
    return np.asarray(ndtri(base) - ndtri(base - np.asarray(points)), dtype=np.float64)


def false_claims(
    truth: str, scenes: int, errors: int, base: float, seeds: int = 1, runs: int = RUNS
) -> tuple[float, float]:
    """Return the shares of scans that report any pair that cancels, and any error that covers for
    another one."""
    stream = generator("statistics", f"scan {truth} {scenes} {errors} {base} {seeds}", 0)
    system, claims = Scanned.of(truth, base, errors, seeds), np.zeros(2)
    for _ in range(runs):
        kinds = {pair.kind for pair in system.scan(stream, scenes).pairs.values()}
        claims += [kind in kinds for kind in ("cancel", "covers")]
    cancel, covers = claims / runs
    return float(cancel), float(covers)


def power(others: float, base: float, trials: int, runs: int = RUNS) -> float:
    """Return the share of scans of 38 errors that report the planted pair."""
    stream = generator("statistics", f"planted {others} {base} {trials}", 0)
    system, reported = Scanned.with_pair(base, others), 0
    for _ in range(runs):
        pairs = system.scan(stream, trials=trials).pairs
        reported += PLANTED in pairs and pairs[PLANTED].kind == "cancel"
    return reported / runs


def sections() -> Iterator[Section]:
    """Yield both tables of scans."""
    yield (
        "Scans for errors that cancel",
        lambda: markdown(
            ("truth", *(f"{claim}, {n}" for claim, n in product(CLAIMS, SECOND))),
            ((name, *scan_claims(truth)) for truth, name in TRUTHS.items()),
        ),
    )
    yield (
        "Scans with a pair that cancels",
        lambda: markdown(
            ("cost of the others", *(f"{trials:,}" for trials in TRIALS)),
            (
                (
                    f"{100 * others:g} points",
                    *(share(power(others, base, trials) for base in BASES) for trials in TRIALS),
                )
                for others in OTHERS
            ),
        ),
    )


def scan_claims(truth: str) -> Iterator[str]:
    """Yield the entries of a row: each false claim, with few and with many other scenes."""
    columns: list[list[str]] = []
    for scenes in SECOND:
        counts = (1, 3) if (truth, scenes) == ("equal", min(SECOND)) else (1,)
        sizes = product(ERRORS, BASES, counts)
        rates = [false_claims(truth, scenes, *size) for size in sizes]
        columns.append([share(of) for of in zip(*rates, strict=True)])
    for claim in zip(*columns, strict=True):
        yield from claim
