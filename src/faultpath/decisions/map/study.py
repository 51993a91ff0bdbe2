"""The trials of a map: at each point two errors at two modules of one source."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from faultpath.core.errors import UserError
from faultpath.decisions import CORRECT
from faultpath.decisions.compared import Compared, compared
from faultpath.decisions.map.asked import MapQuestion, SizedFault, check_up_to, places, sized_fault
from faultpath.decisions.map.lattice import COARSE, UNITS, Point, lattice
from faultpath.decisions.map.surface import Differences
from faultpath.decisions.planning import scenes_of, two_variants
from faultpath.faults import Fault
from faultpath.trials import (
    Arm,
    Library,
    OutcomeTable,
    Row,
    Study,
    System,
    SystemSpec,
    Variant,
)
from faultpath.trials import question as asking

COARSE_POINTS = len(lattice(COARSE))

_MOST_POINTS = 10_000
"""A hundred errors of each module."""


@dataclass(frozen=True)
class MapPlan:
    """A question about two errors, and the trials that answer it at any points."""

    question: MapQuestion
    system: System
    spec: SystemSpec
    fault: SizedFault = field(repr=False)
    scenes: tuple[str, ...] = field(repr=False)

    @property
    def name(self) -> str:
        """Name of its studies: the same whatever spread or number of points is asked for."""
        asked = self.question
        return f"{self.spec.name}-map-{asked.repair}-vs-{asked.baseline}"

    def size(self, units: int) -> float:
        """Return an error from a coordinate of a point."""
        return round(self.question.up_to * units / UNITS, 12)

    def path(self, point: Point) -> str:
        """Return what rows of a point are called in the outcome table."""
        return ",".join(f"{self.size(each):+.6g}" for each in point) if any(point) else CORRECT

    def study(self, points: Sequence[Point]) -> Study:
        """Return the study of all points. Arms that a fault cannot reach are flown once."""
        variants = [self.system.variants[n] for n in (self.question.baseline, self.question.repair)]
        rows = tuple(
            Row(
                variant=variant.name,
                path=self.path(point),
                seed=seed,
                arm=Arm(variant=variant.name, faults=self._faults(point, variant), seed=seed),
            )
            for point in points
            for variant in variants
            for seed in self.question.seeds
        )
        return Study(
            name=self.name,
            system=self.spec,
            library=self.question.library,
            scenes=self.scenes,
            rows=rows,
        )

    def _faults(self, point: Point, variant: Variant) -> tuple[Fault, ...]:
        """Return the faults of a point, in a variant; equal errors are one fault that is shared,
        as in an audit."""
        by_size: dict[int, list[str]] = {}
        for module, units in zip(self.question.against, point, strict=True):
            if units:
                by_size.setdefault(units, []).append(module)
        return tuple(
            part
            for units, modules in by_size.items()
            for part in self.fault.at(self.size(units))
            .striking(*modules)
            .resolved(self.system.interface, variant.consumers)
        )

    def compared(self, points: Sequence[Point], table: OutcomeTable) -> Compared:
        """Return the pairs of all points, cut to the scenes that every one has.

        `UserError` where a point has none.
        """
        names = [self.path(point) for point in points]
        found = compared(self.question.repair, self.question.baseline, names, table)
        if found.void:
            raise UserError(
                f"at the errors {' and '.join(found.void[:3])} no pair is left to compare, because "
                "trials failed there: mend what made them fail, or choose a smaller --up-to."
            )
        return found

    def differences(self, points: Sequence[Point], found: Compared) -> Differences:
        """Return success at all points."""
        arms = [found.arms[self.path(point)] for point in points]
        repair, baseline = (np.array(each, dtype=np.float64) for each in zip(*arms, strict=True))
        return Differences(tuple(points), repair, baseline)


def plan_map(
    system: System, spec: SystemSpec, asked: asking.MapQuestion, library: Library
) -> MapPlan:
    """Lay out a map. `UserError` for anything that cannot be run or means nothing."""
    variants = two_variants(system, asked)
    sized = sized_fault(system, asked.fault)
    largest = check_up_to(sized, asked.up_to)
    for end in (-largest, largest):
        sized.at(end)
    modules, others = places(system.interface, sized.at(largest), asked.against, variants)
    if not COARSE_POINTS <= asked.points <= _MOST_POINTS:
        raise UserError(
            f"--points {asked.points}: a map begins with {COARSE_POINTS} and takes at most "
            f"{_MOST_POINTS}, give a number between them."
        )
    chosen = scenes_of(library, asked.scenes)
    middle, spread = _distribution(asked.mean, asked.spread, asked.correlation, largest, sized)
    question = MapQuestion(
        system=spec.name,
        options=spec.options,
        baseline=asked.baseline,
        repair=asked.repair,
        fault=asked.fault,
        against=modules,
        others=others,
        up_to=largest,
        relative=sized.relative,
        unit=sized.unit,
        means=middle,
        spreads=spread,
        correlation=asked.correlation,
        points=asked.points,
        library=library.name,
        library_hash=library.content_hash,
        n_scenes=len(chosen),
        seeds=asked.seeds,
        trained=system.trained,
    )
    return MapPlan(question, system, spec, sized, chosen)


def _distribution(
    means: Sequence[float],
    spreads: Sequence[float],
    correlation: float | None,
    largest: float,
    fault: SizedFault,
) -> tuple[tuple[float, float], tuple[float, float]]:
    given = spreads or (fault.expected or largest / 2.0,)
    spread = _two("--spread", given)
    if min(spread) <= 0.0:
        raise UserError("--spread: a standard deviation is above 0.")
    middle = _two("--mean", means)
    if max(map(abs, middle)) > largest:
        raise UserError(f"--mean lies beyond the map, which ends at {largest:g}: see --up-to.")
    if correlation is not None and not -1.0 <= correlation <= 1.0:
        raise UserError(f"--correlation {correlation:g} does not lie between -1 and 1.")
    return middle, spread


def _two(option: str, values: Sequence[float]) -> tuple[float, float]:
    if len(values) not in (1, 2) or any(value - value != 0.0 for value in values):
        raise UserError(
            f"{option} needs one finite number, or one for each module: 0.1 or 0.1,0.2."
        )
    return values[0], values[-1]
