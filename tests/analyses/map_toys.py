"""Maps without a simulator: what scenes show at a point is a function of both errors."""

from collections.abc import Callable

import numpy as np
from outcome_tables import BASELINE, REPAIR

from faultpath.analyses.map import decide
from faultpath.analyses.map.lattice import COARSE, UNITS, Point, lattice
from faultpath.analyses.map.model import MapFacts, MapResult
from faultpath.analyses.map.surface import Differences, next_points
from faultpath.faults import FaultText
from faultpath.run.findings import Finding
from faultpath.run.question import MapQuestion

MODULES = ("observer", "predictor")
QUESTION = MapQuestion(
    baseline=BASELINE, repair=REPAIR, fault=FaultText.read("gain"), against=MODULES, points=25
)
FACTS = MapFacts(
    system="toy",
    library="made up",
    library_hash="hash-1",
    n_scenes=100,
    modules=MODULES,
    up_to=0.4,
    relative=True,
    unit="1",
    means=(0.0, 0.0),
    spreads=(0.2, 0.2),
)
Seen = Callable[[float, float], tuple[np.ndarray, np.ndarray]]
"""From two errors to success of the repair and of the baseline, `[scenes]`."""


def concluded(differences: Differences, *findings: Finding) -> MapResult:
    return decide.concluded(QUESTION, FACTS, differences, findings=findings)


def differences(seen: Seen, points: tuple[Point, ...], seeds: int = 1) -> Differences:
    variants = [seen(x / UNITS, y / UNITS) for x, y in points]
    repair, baseline = (
        np.array(each, dtype=float)[..., None] for each in zip(*variants, strict=True)
    )
    return Differences(points, np.repeat(repair, seeds, 2), np.repeat(baseline, seeds, 2))


def grown(seen: Seen, limit: int = 81) -> Differences:
    points = lattice(COARSE)
    while new := next_points(differences(seen, points), MODULES, limit, "toy"):
        points += new
    return differences(seen, points)


def record(seen: Seen, **facts: object) -> MapResult:
    return decide.concluded(QUESTION, FACTS.model_copy(update=facts), grown(seen))


def reversal(scenes: int) -> Seen:
    """A baseline whose two errors cancel, and a repair that looks at one error only; it is ahead
    where the errors differ much."""
    bears = (np.arange(scenes) + 0.5) / scenes

    def seen(x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        return bears > 0.3 + 0.2 * abs(x), bears > abs(x - y)

    return seen


def alike(scenes: int) -> Seen:
    return lambda x, y: (np.arange(scenes) % 2 > 0, np.arange(scenes) % 2 > 0)
