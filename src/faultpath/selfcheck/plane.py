"""How often a map of equal arms announces anything, how often it holds the true break-even
correlation, and how often what it says of turning sizes is true.

A scene bears errors up to a size of its own: the baseline succeeds while the two errors differ by
less, as they compensate each other, the repair while the first error alone is less.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from faultpath.plane.decide import turns
from faultpath.plane.grow import next_points
from faultpath.plane.joint import Errors, Expected
from faultpath.plane.lattice import (
    COARSE,
    SHOWN,
    UNITS,
    Point,
    along,
    lattice,
    rays,
    sizes,
    surface_weights,
)
from faultpath.plane.model import Flip
from faultpath.plane.surface import Combined, Differences
from faultpath.selfcheck.model import Measured
from faultpath.statistics.inputs import Floats
from faultpath.streams import generator

EQUAL_MAPS, CORRELATION = "equal maps", "break-even correlation"
PLACES = "decided places"
TURNS, TURNS_FOUND = "turning sizes", "turning sizes found"
_TRUTHS = (CORRELATION, TURNS, PLACES)
MODULES = ("first", "second")
POINTS = 81
SPREAD, BEARS, COST = 0.4, 0.6, 0.1
"""Spread of both errors, typical size that a scene bears, share that the repair never solves; of
the largest error of the map and as a fraction."""


_ERRORS = Errors((0.0, 0.0), (SPREAD, SPREAD))
_LOOKS = np.linspace(-1.0, 1.0, 41)


def grown(scenes: "Scenes | Waves") -> Differences:
    """Return the points that a map of these scenes flies, with what it sees there."""
    points = list(lattice(COARSE))
    while True:
        found = scenes.differences(points)
        new = next_points(found, MODULES, POINTS, "selfcheck")
        if not new:
            return found
        points += new


@dataclass(frozen=True)
class Scenes:
    """Sizes that scenes bear with the baseline and with the repair, `[scenes]`."""

    baseline: Floats
    repair: Floats
    equal: bool
    """Whether the repair is the baseline, but for luck."""

    @classmethod
    def draw(cls, stream: np.random.Generator, scenes: int, alike: float, equal: bool) -> "Scenes":
        """Draw scenes, a share `alike` of which bears the same in both."""
        bears = BEARS * np.sqrt(2.0 * stream.exponential(size=(2, scenes)))
        bears[1] = np.where(stream.random(scenes) < alike, bears[0], bears[1])
        bears[1] = np.where(stream.random(scenes) < COST * (not equal), -1.0, bears[1])
        return cls(bears[0], bears[1], equal)

    def differences(self, points: Sequence[Point]) -> Differences:
        """Return what is seen at points."""
        x, y = np.array(points, dtype=np.float64).T[:, :, np.newaxis] / UNITS
        apart = np.abs(x - y)
        repair = (apart if self.equal else np.abs(x)) < self.repair
        baseline = apart < self.baseline
        return Differences(
            tuple(points),
            repair[:, :, np.newaxis].astype(np.float64),
            baseline[:, :, np.newaxis].astype(np.float64),
        )


@dataclass(frozen=True)
class Waves:
    """Scenes that end as a plane wave of errors has it, another one in each arm: places of the map
    depend on each other as little as they may."""

    sides: Floats
    """Of the wave vectors and the phases, `[arms, scenes, 3]`."""

    @classmethod
    def draw(cls, stream: np.random.Generator, scenes: int) -> "Waves":
        """Draw scenes."""
        drawn = stream.normal(size=(2, scenes, 3)) * 8.0
        drawn[..., 2] = stream.uniform(0.0, 2.0 * np.pi, size=(2, scenes))
        return cls(drawn)

    def differences(self, points: Sequence[Point]) -> Differences:
        """Return what is seen at points."""
        place = np.concatenate([np.array(points) / UNITS, np.ones((len(points), 1))], axis=1)
        ends = np.cos(np.einsum("pk,ask->aps", place, self.sides)) > 0.0
        repair, baseline = ends[..., np.newaxis].astype(np.float64)
        return Differences(tuple(points), repair, baseline)


def truth(points: Sequence[tuple[float, float]]) -> Floats:
    """Return the true difference at points, a fraction."""
    x, y = np.array(points, dtype=np.float64).T / UNITS
    return (1.0 - COST) * np.exp(-0.5 * (x / BEARS) ** 2) - np.exp(-0.5 * ((x - y) / BEARS) ** 2)


def true_correlation() -> float:
    """Return the correlation at which both arms are expected to do equally well."""
    ratio = (SPREAD / BEARS) ** 2
    return 1.0 - ((1.0 + ratio) / (1.0 - COST) ** 2 - 1.0) / (2.0 * ratio)


@dataclass(frozen=True)
class EqualMaps:
    """Maps of arms that are equal everywhere."""

    scenes: int
    alike: float | None
    """Share of scenes that end alike in both arms; `None`: they are `Waves`."""
    runs: int

    def measure(self) -> tuple[Measured, ...]:
        """Return the share of maps that announce anything: of a place, and of a correlation."""
        stream = generator("selfcheck", repr(self), 0)
        announced = {"place": 0, "correlation": 0}
        for _ in range(self.runs):
            found = grown(
                Waves.draw(stream, self.scenes)
                if self.alike is None
                else Scenes.draw(stream, self.scenes, self.alike, equal=True)
            )
            announced["place"] += _announces(found)
            expected = Expected.over(_ERRORS, found, "selfcheck")
            announced["correlation"] += not expected.undecided(_LOOKS).all()
        alike = "waves" if self.alike is None else self.alike
        return tuple(
            Measured(
                EQUAL_MAPS,
                {"scenes": self.scenes, "alike": alike, "of": of},
                number / self.runs,
                self.runs,
            )
            for of, number in announced.items()
        )


def _announces(found: Differences) -> bool:
    flips, z = turns(found, MODULES, 1.0, "selfcheck")
    weights = np.concatenate([np.eye(len(found.points)), surface_weights(found.points)])
    places = Combined.of(weights, found).signs(z).any()
    return bool(places) or any(flip.start or flip.turned for flip in flips)


def _true_places(found: Differences, z: float, straight: bool) -> bool:
    weights = surface_weights(found.points)
    signs = Combined.of(weights, found).signs(z)
    heights = weights @ truth(found.points) if straight else truth(lattice(SHOWN))
    return bool((signs * np.sign(heights) >= 0).all())


@dataclass(frozen=True)
class Truths:
    """Maps of arms that differ, by what is known of them."""

    scenes: int
    alike: float
    runs: int

    def measure(self) -> tuple[Measured, ...]:
        """Return how often the set of correlations holds the true break-even correlation, and how
        often nothing false is said of any path; by either truth, that of the map, straight between
        its points, and that of the errors. Last, how often a turn is found, where one is."""
        stream = generator("selfcheck", repr(self), 0)
        held = {(section, straight): 0 for section in _TRUTHS for straight in (1, 0)}
        decided = 0
        for _ in range(self.runs):
            found = grown(Scenes.draw(stream, self.scenes, self.alike, equal=False))
            expected = Expected.over(_ERRORS, found, "selfcheck")
            true = np.array([_of_the_map(expected), true_correlation()])
            flips, z = turns(found, MODULES, 1.0, "selfcheck")
            for straight, covered in zip((1, 0), expected.undecided(true).tolist(), strict=True):
                held[CORRELATION, straight] += covered
                held[TURNS, straight] += all(holds(f, found, bool(straight)) for f in flips)
                held[PLACES, straight] += _true_places(found, z, bool(straight))
            decided += any(f.start and f.turned for f in flips if f.path == MODULES[1])
        setting = {"scenes": self.scenes, "alike": self.alike}
        rates = [
            Measured(section, {**setting, "straight": straight}, number / self.runs, self.runs)
            for (section, straight), number in held.items()
        ]
        return *rates, Measured(TURNS_FOUND, setting, decided / self.runs, self.runs)


def holds(flip: Flip, found: Differences, straight: bool) -> bool:
    """Return whether the truth is on the side that is announced, wherever that is on a path."""
    way = rays(MODULES)[flip.path, flip.direction]
    looked = np.linspace(0.0, UNITS, 4 * UNITS + 1)
    if straight:
        known = sizes(way, found.points)
        heights = np.interp(looked, known, truth([along(way, size) for size in known]))
    else:
        heights = truth([(way[0] * size, way[1] * size) for size in looked.tolist()])
    at = looked / UNITS
    said = [(flip.start, 0.0, flip.until), (flip.turned, flip.first, flip.last)]
    return all(
        bool((sign * heights[(at >= abs(low)) & (at <= abs(high))] > 0.0).all())
        for sign, low, high in said
        if sign and low is not None and high is not None
    )


def _of_the_map(expected: Expected) -> float:
    heights = expected.surface @ truth(expected.found.points)
    low, high = -1.0, 1.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        above = float(expected.errors.weights(middle) @ heights) > 0.0
        low, high = (middle, high) if above else (low, middle)
    return 0.5 * (low + high)


def map_grid(scenes: Sequence[int], runs: int) -> Iterator[EqualMaps | Truths]:
    """Yield the grid: what equal arms announce, then what is known of arms that differ."""
    for n, alike in product(scenes, (0.0, 0.7, None)):
        yield EqualMaps(n, alike, runs)
    for n, alike in product(scenes, (0.0, 0.7)):
        yield Truths(n, alike, runs)
