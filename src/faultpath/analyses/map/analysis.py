"""Question and trials of a map: at each point two errors at two modules of one source."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath

import numpy as np

from faultpath.analyses.analysis import Analysis, Round, Rounds, rows_of, scenes_of, two_variants
from faultpath.analyses.contrasts import compared
from faultpath.analyses.facts import facts_of, question_of
from faultpath.analyses.map.decide import concluded
from faultpath.analyses.map.lattice import COARSE, Point, lattice
from faultpath.analyses.map.model import MapFacts, MapResult
from faultpath.analyses.map.surface import Differences, next_points
from faultpath.analyses.model import CORRECT
from faultpath.core.errors import UserError
from faultpath.core.text import listed
from faultpath.faults import Fault, FaultText, at_readers, describe, reaching
from faultpath.interface import module_of
from faultpath.run.deliveries import Deliveries
from faultpath.run.findings import Unpaired
from faultpath.run.plan import Plan, Row, SystemSpec
from faultpath.run.question import MapQuestion
from faultpath.run.trials import Trials
from faultpath.system.declared import Library, Variant
from faultpath.system.system import System

_LEAST, _LARGEST = 1e-6, 1e12
"""Bounds of the largest error: sizes keep twelve digits after the point, and no system has more."""
_MOST_POINTS = 10_000
"""A hundred errors of each module."""
_BISECTING = 18
"""Points that are typically added to bisect where the ranking turns."""


@dataclass(frozen=True)
class MapAnalysis(Analysis[list[Point]]):
    """A question about two errors, and the trials that answer it at any points."""

    noun = "pairs of errors"

    question: MapQuestion
    facts: MapFacts
    spec: SystemSpec
    fault: FaultText
    """Without a size."""
    scenes: tuple[str, ...] = field(repr=False)

    def rounds(self) -> Rounds[list[Point]]:
        """Yield the coarse lattice, then with it points where no difference is significant."""
        question, points = self.question, list(lattice(COARSE))
        expected = question.points + _BISECTING
        plan = self.plan(points)
        first = len(plan.rows) * len(self.scenes)
        notice = (
            f"{len(points)} pairs of errors first, {first} trials; then more where no difference "
            f"is significant, about {round(first * max(1.0, expected / len(points)))} trials at "
            "most."
        )
        while True:
            table = yield Round(plan, len(points), expected, notice)
            differences, _ = self.differences(points, table)
            modules, most, drawn = self.facts.modules, question.points, self.facts.library_hash
            new = next_points(differences, modules, most, drawn)
            if not new:
                return points
            points += new
            plan, notice = self.plan(points), ""

    def conclude(self, trials: Trials, deliveries: Deliveries, items: Sequence[Point]) -> MapResult:
        """Return the result of a map, to the bit the same in whatever order its points were run.

        `UserError` where a point has no pair left.
        """
        differences, unpaired = self.differences(sorted(items), trials)
        findings = (*Unpaired.first_of(unpaired), *deliveries.findings)
        return concluded(self.question, self.facts, differences, int(trials.failed.sum()), findings)

    def condition(self, point: Point) -> str:
        """Return what rows of a point are called in the outcome table."""
        sizes = (f"{self.facts.size(units):+.6g}" for units in point)
        return ",".join(sizes) if any(point) else CORRECT

    def plan(self, points: Sequence[Point]) -> Plan:
        """Return the plan of all points. Variants that a fault cannot reach run once.

        Equal errors are one fault that is shared, as in an audit. Plans of one fault,
        pair of modules, range, library and seeds have the same name, whatever the spread and the
        number of points.
        """
        question, facts, rows = self.question, self.facts, list[Row]()
        for point in points:
            by_size: dict[int, list[str]] = {}
            for module, units in zip(facts.modules, point, strict=True):
                if units:
                    by_size.setdefault(units, []).append(module)
            faults = [
                fault
                for units, modules in by_size.items()
                for fault in at_readers(_sized(self.system, self.fault, facts.size(units)), modules)
            ]
            for name in (question.baseline, question.repair):
                parts = at_readers(faults, self.system.variants[name].readers)
                rows += rows_of(self.condition(point), {name: parts}, question.seeds)
        return Plan(
            name=f"{'-'.join(self.named)}-seeds-{','.join(map(str, question.seeds))}",
            system=self.spec,
            library=facts.library,
            scenes=self.scenes,
            rows=tuple(rows),
        )

    def differences(
        self, points: Sequence[Point], trials: Trials
    ) -> tuple[Differences, tuple[Unpaired, ...]]:
        """Return success at all points, cut to the scenes that every one has, and the pairs that
        met different conditions; `UserError` where a point has no pair."""
        names = [self.condition(point) for point in points]
        comparison = compared(self.question.repair, self.question.baseline, names, trials)
        if comparison.missing:
            raise UserError(
                f"at the errors {' and '.join(comparison.missing[:3])} no pair is left to compare, "
                "because trials failed there: fix what made them fail, or choose a smaller "
                "--up-to."
            )
        success = np.array([comparison.success[name] for name in names])
        whole = ~np.isnan(success).any(axis=(0, 1, 3))
        if not whole.any():
            raise UserError(
                "no scene has all of its trials at every pair of errors: fix what made them fail."
            )
        repair, baseline = success[:, 0, whole], success[:, 1, whole]
        return Differences(tuple(points), repair, baseline), comparison.unpaired


def map_analysis(
    system: System, spec: SystemSpec, request: MapQuestion, library: Library
) -> MapAnalysis:
    """Lay out a map. `UserError` for anything that cannot be run or means nothing."""
    variants, interface = two_variants(system, request), system.interface
    fault = _without_size(system, request.fault)
    relative = fault.kind != "offset"
    parts = _sized(system, fault, 0.1 if relative else 1.0)
    sources = [interface.source(interface.channel(part.channel).sources[0]) for part in parts]
    errors = [source.uncertainty for source in sources if source.uncertainty]
    unsure = [error.expected_std for error in errors if error.relative is relative]
    largest = _largest(request, max(unsure, default=None), relative)
    ends = [_sized(system, fault, end) for end in (-largest, largest)]
    modules, others = _places(ends[1], request.against, variants)
    least = len(lattice(COARSE))
    if not least <= request.points <= _MOST_POINTS:
        raise UserError(
            f"--points {request.points}: a map begins with {least} and takes at most "
            f"{_MOST_POINTS}, give a number between them."
        )
    chosen = scenes_of(library, request.scenes)
    spread = _two("--spread", request.spread or (max(unsure, default=0.0) or largest / 2.0,))
    if not 0.0 < min(spread) <= max(spread) <= 1000 * largest:
        raise UserError(f"--spread: give standard deviations above 0, up to {1000 * largest:g}.")
    middle = _two("--mean", request.mean)
    if max(map(abs, middle)) > largest:
        raise UserError(f"--mean lies beyond the map, which ends at {largest:g}: see --up-to.")
    if request.correlation is not None and not -1.0 <= request.correlation <= 1.0:
        raise UserError(f"--correlation {request.correlation:g} does not lie between -1 and 1.")
    facts = MapFacts(
        **facts_of(system, spec, library),
        n_scenes=len(chosen),
        modules=modules,
        others=others,
        up_to=largest,
        relative=relative,
        unit=sources[0].unit,
        means=middle,
        spreads=spread,
    )
    question = question_of(request, MapQuestion, spec)
    name = f"{spec.name}-map-{request.repair}-vs-{request.baseline}"
    named = (name, str(request.fault), *modules, f"{largest:g}", PurePath(request.library).stem)
    return MapAnalysis(question, system, named, facts, spec, fault, chosen)


def _without_size(system: System, fault: FaultText) -> FaultText:
    """Return a fault that takes sizes of both signs, with its kind unless it is a preset."""
    if fault.joined:
        raise UserError(f"fault '{fault}': a map takes one fault; leave '&' out.")
    if fault.sizes:
        raise UserError(
            f"fault '{fault}': the map sets the size itself; leave '={fault.sizes[0]}' out and "
            "give the largest one with --up-to."
        )
    if fault.readers:
        raise UserError(f"fault '{fault}': name the modules with --against, without '@'.")
    if fault.kind is None and fault.name not in system.fault_presets:
        return replace(fault, kind="scale")
    if fault.kind not in (None, "scale", "offset"):
        raise UserError(
            f"fault '{fault}': a map needs errors of both signs; use {fault.name}:scale (relative, "
            f"the default) or {fault.name}:offset, not '{fault.kind}'."
        )
    return fault


def _sized(system: System, fault: FaultText, size: float) -> tuple[Fault, ...]:
    """Return a fault of a size at every reader; `UserError` where it takes no such size."""
    return system.fault(fault.at(f"{1.0 + size if fault.kind == 'scale' else size:.12g}"))


def _largest(request: MapQuestion, expected: float | None, relative: bool) -> float:
    """Return the largest error of a map: as asked, or three declared spreads."""
    largest = request.up_to
    if largest is None:
        if expected is None:
            raise UserError(
                "the interface declares no uncertainty of that source: say how large errors may "
                "be, for example --up-to 0.2 for 20 % to either side."
            )
        return float(f"{3.0 * expected:.2g}")
    if not _LEAST <= largest <= _LARGEST:
        raise UserError(
            f"--up-to {largest:g} is no size: give a number from {_LEAST:g} to {_LARGEST:g}."
        )
    if relative and largest >= 1.0:
        raise UserError(
            f"--up-to {largest:g} would take all of the reading away: errors are fractions of it, "
            "so give less than 1."
        )
    return largest


def _places(
    faults: Sequence[Fault], against: tuple[str, ...], variants: Sequence[Variant]
) -> tuple[tuple[str, str], tuple[str, ...]]:
    """Return the two modules, and the other readers of what the fault acts on."""
    if len(against) != 2 or len(set(against)) < 2 or not all(against):
        raise UserError(
            "--against needs two modules that read the faulty source, as in "
            "--against reconstruction,predictor."
        )
    present = frozenset[str]().union(*(variant.readers for variant in variants))
    faults = reaching(faults, present)

    def readers(faults: Iterable[Fault]) -> set[str]:
        return {place for fault in faults for place in fault.readers}

    reached = [readers(at_readers(faults, (name,))) for name in against]
    for name, places in zip(against, reached, strict=True):
        if not places:
            both = " nor ".join(f"'{variant.name}'" for variant in variants)
            raise UserError(
                f"--against: neither {both} has '{name}' read what the fault ({describe(faults)}) "
                f"acts on: name two of {listed({module_of(place) for place in readers(faults)})}."
            )
    if both := reached[0] & reached[1]:
        raise UserError(f"--against: both names hold {min(both)}: name two that share no place.")
    others = sorted({module_of(c) for c in readers(faults) - reached[0] - reached[1]})
    return (against[0], against[1]), tuple(others)


def _two(option: str, values: Sequence[float]) -> tuple[float, float]:
    if len(values) not in (1, 2) or not all(map(math.isfinite, values)):
        raise UserError(
            f"{option} needs one finite number, or one for each module: 0.1 or 0.1,0.2."
        )
    return values[0], values[-1]
