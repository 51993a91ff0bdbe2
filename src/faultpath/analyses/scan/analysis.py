"""Which trials a scan runs: errors alone in the first stage, and pairs in the second."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import PurePath

from faultpath.analyses.analysis import Analysis, Round, Rounds, rows_of, scenes_of
from faultpath.analyses.facts import facts_of, question_of
from faultpath.analyses.model import CORRECT
from faultpath.analyses.scan.decide import concluded, first_stages, going_on, hurting
from faultpath.analyses.scan.errors import (
    Scanned,
    by_source,
    different,
    errors_of,
    faults_of,
    halved,
    label,
    most_conditions,
)
from faultpath.analyses.scan.model import ScanError, ScanFacts, ScanResult
from faultpath.analyses.scan.ranking import PROBED_SCENES, ranking
from faultpath.analyses.scan.sources import Candidate, Ranking, candidates
from faultpath.core.errors import UserError
from faultpath.core.text import listed, unknown
from faultpath.faults import at_readers
from faultpath.run.deliveries import Deliveries
from faultpath.run.plan import Plan, Row, SystemSpec
from faultpath.run.question import ScanQuestion
from faultpath.run.trials import Trials
from faultpath.stats.cancelling import fewest_scenes
from faultpath.system.declared import Library, Variant
from faultpath.system.loop_system import LoopSystem
from faultpath.system.system import System

FIRST_SCENES = 50
"""Scenes of the first stage."""
TRIALS = 8000
"""Trials of a scan without a number of scenes; more where it needs more."""
COSTLY_PP = 50.0
"""An error that costs more is halved: where all fail, no error can be compared."""
HALVINGS = 3
"""Most halvings of an error."""


@dataclass(frozen=True)
class ScanAnalysis(Analysis[Scanned]):
    """A question about the errors of a system's inputs, and the trials that answer it."""

    noun = "conditions"

    question: ScanQuestion
    facts: ScanFacts
    spec: SystemSpec
    ranking: Ranking
    errors: tuple[ScanError, ...]
    first: tuple[str, ...] = field(repr=False)
    """Scenes of the first stage."""
    others: tuple[str, ...] = field(repr=False)
    """Scenes that are left for the second."""

    def check_scenes(self) -> None:
        """Raise `UserError` where scenes or trials are fewer than the correction needs."""
        errors, pairs, _ = most_conditions(self.errors)
        if not pairs:
            raise UserError(
                f"{self.system.name}: {listed({error.source for error in self.errors})} has one "
                "reader, so no two errors can act together: give the error of another source with "
                "--fault."
            )
        least = fewest_scenes(errors, pairs)
        needed = FIRST_SCENES + least
        if len(self.others) < least:
            raise UserError(
                f"{len(self.first) + len(self.others)} scenes of '{self.facts.library}' are too "
                f"few for a scan of {len(self.errors)} errors: {FIRST_SCENES} choose errors and "
                f"{least} others test up to {pairs} pairs, so {needed} would do."
            )
        trials = self.trials(least)
        if self.question.scenes is None and trials > TRIALS:
            raise UserError(
                f"a scan of {len(self.errors)} errors takes {trials} trials at least, and {TRIALS} "
                f"are run unless you say so: give --scenes {needed} or more."
            )

    def rounds(self) -> Rounds[Scanned]:
        """Yield each error alone, then with halved sizes, and then the pairs in other scenes."""
        errors, tried, sizes = self.errors, list(self.errors), [self.errors]
        # In scenes of the first stage, however many the second has.
        most = max(1 + len(tried), round(self.expected() / (self.per_scene * len(self.first))))
        trials = yield Round(self.plan(tried), 1 + len(tried), most, self.notice())
        for _ in range(HALVINGS):
            costly = self.costly(errors, trials)
            if not costly:
                break
            errors = tuple(halved(e) if (e.source, e.sign) in costly else e for e in errors)
            sizes.append(errors)
            tried += [error for error in errors if error not in tried]
            trials = yield Round(self.plan(tried), 1 + len(tried), most)
        errors = self.largest_that_hurts(sizes, trials)
        chosen = going_on(self.question, errors, trials, self.first)
        scanned = self.second_stage(tuple(tried), errors, chosen)
        conditions = scanned.conditions
        if len(conditions) > 1:
            count = 1 + len(tried) + len(conditions)
            yield Round(self.plan(tried, scanned), count, count)
        return scanned

    @property
    def per_scene(self) -> int:
        """Trials of one condition in one scene."""
        return len(self.question.variants) * len(self.question.seeds)

    def expected(self, halvings: int = 0) -> int:
        """Return about how many trials there will be at most, if all sizes are halved so often."""
        halved = self.per_scene * halvings * len(self.errors) * len(self.first)
        most = self.trials(len(self.others)) + halved
        return most if self.question.scenes is not None else min(TRIALS, most)

    def trials(self, second: int) -> int:
        """Return the trials of a scan with so many scenes in its second stage, at most, without
        those of halved sizes."""
        first = (1 + len(self.errors)) * len(self.first)
        return self.per_scene * (first + most_conditions(self.errors)[2] * second)

    def costly(self, errors: Sequence[ScanError], trials: Trials) -> set[tuple[str, int]]:
        """Return the sources and signs of which an error costs too much in some variant."""
        return {
            (error.source, error.sign)
            for stage in first_stages(self.question, errors, trials, self.first)
            for error, loss in zip(errors, stage.losses.tolist(), strict=True)
            if loss > COSTLY_PP
        }

    def largest_that_hurts(
        self, sizes: Sequence[tuple[ScanError, ...]], trials: Trials
    ) -> tuple[ScanError, ...]:
        """Return the errors with their last size, or with one before it where half of that is not
        seen to cost anything: one halving too many would hide an error."""
        errors = sizes[-1]
        for larger in reversed(sizes[:-1]):
            hurt = hurting(self.question, errors, trials, self.first)
            errors = tuple(
                error if (error.source, error.sign) in hurt else before
                for error, before in zip(errors, larger, strict=True)
            )
        return errors

    def second_stage(
        self, tried: tuple[ScanError, ...], errors: tuple[ScanError, ...], chosen: tuple[int, ...]
    ) -> Scanned:
        """Return the conditions of the second stage, and as many scenes as the trials allow."""
        groups = by_source(errors)
        alike = {place: group for group in groups.values() for place in group}
        singles = tuple(dict.fromkeys((*chosen, *(p for c in chosen for p in alike[c]))))
        paired = dict.fromkeys(
            pair for pair in combinations(sorted(chosen), 2) if different(errors, pair)
        )
        paired |= dict.fromkeys(p for c in chosen for p in combinations(alike[c], 2))
        together = [group for group in groups.values() if len(group) > 1]
        together += [
            tuple(place for place in group if place != left_out)
            for group in groups.values()
            if len(group) > 2
            for left_out in group
        ]
        pairs = tuple(paired)
        scanned = Scanned(tried, errors, chosen, singles, pairs, tuple(together), self.first)
        return scanned._replace(second=self.others[: self._scenes(scanned)])

    def _scenes(self, scanned: Scanned) -> int:
        if self.question.scenes is not None:
            return len(self.others)
        run = self.per_scene * (1 + len(scanned.tried)) * len(self.first)
        least = fewest_scenes(len(scanned.singles), len(scanned.pairs))
        return max(least, (TRIALS - run) // (self.per_scene * len(scanned.conditions)))

    def notice(self) -> str:
        """Say what runs first, and how much in all."""
        first = self.per_scene * (1 + len(self.errors)) * len(self.first)
        return (
            f"{len(self.errors)} errors alone in {len(self.first)} scenes first, {first} trials; "
            "then halves of sizes that cost too much, and pairs of those that cost success, in "
            f"other scenes, at most about {self.expected(HALVINGS)} trials in all."
        )

    def plan(self, tried: Iterable[ScanError], scanned: Scanned | None = None) -> Plan:
        """Return the plan of the first stage, or of both."""
        rows, scenes = list[Row](self._rows((), self.first)), self.first
        for error in tried:
            rows += self._rows((error,), self.first)
        if scanned is not None:
            for places in scanned.conditions:
                rows += self._rows([scanned.errors[place] for place in places], scanned.second)
            scenes += scanned.second
        # Rounds of one scan share a folder, and those of another question must not.
        return Plan(
            name=f"{'-'.join(self.named[:-1])}-seeds-{','.join(map(str, self.question.seeds))}",
            system=self.spec,
            library=self.facts.library,
            scenes=scenes,
            rows=tuple(rows),
        )

    def _rows(self, errors: Sequence[ScanError], scenes: tuple[str, ...]) -> Iterable[Row]:
        faults = faults_of(self.system, errors)
        by_variant = {
            name: at_readers(faults, self.system.variants[name].readers)
            for name in self.question.variants
        }
        for row in rows_of(label(errors) or CORRECT, by_variant, self.question.seeds):
            yield row.model_copy(update={"scenes": scenes})

    def conclude(self, trials: Trials, deliveries: Deliveries, items: Scanned) -> ScanResult:
        """Return the result; `UserError` where no trial of some condition is left."""
        return concluded(self.question, self.facts, self.ranking, items, trials, deliveries)


def scan_analysis(
    system: System,
    spec: SystemSpec,
    request: ScanQuestion,
    library: Library,
    known: Ranking | None = None,
) -> ScanAnalysis:
    """Lay out the first stage, and rank the sources where their ranking is not known.

    Raises `UserError` for an unknown variant, one that is both, a fault that a scan cannot take,
    where no source has a size, and for fewer scenes than a scan needs.
    """
    every = candidates(system, _variants(system, request), request.fault)
    errors = errors_of(system, every)
    if not errors:
        raise _nothing_sized(system, every)
    chosen = scenes_of(library, request.scenes)
    others = [name for name in system.variants if name not in request.named_variants]
    facts = ScanFacts(
        **facts_of(system, spec, library),
        other=others[0] if len(others) == 1 else "",
    )
    faults = map(str, request.fault)
    named = (
        f"{spec.name}-scan-{'-'.join(request.named_variants)}",
        *faults,
        PurePath(library.name).stem,
    )
    analysis = ScanAnalysis(
        question=question_of(request, ScanQuestion, spec),
        facts=facts,
        system=system,
        named=named,
        spec=spec,
        ranking=Ranking(system="", variants=(), sources=(), probed=0),
        errors=errors,
        first=chosen[:FIRST_SCENES],
        others=chosen[FIRST_SCENES:],
    )
    analysis.check_scenes()
    return replace(analysis, ranking=known or ranked_sources(system, request, library))


def ranked_sources(system: System, request: ScanQuestion, library: Library) -> Ranking:
    """Return the sources that may err, ranked; `UserError` as `scan_analysis`."""
    variants = _variants(system, request)
    every = candidates(system, variants, request.fault)
    scenes = scenes_of(library, min(PROBED_SCENES, len(library.scenes)))
    return Ranking(
        system=system.name,
        variants=request.named_variants,
        sources=ranking(system, variants, every, scenes, request.seeds[0]),
        probed=len(scenes) if isinstance(system, LoopSystem) else 0,
    )


def _variants(system: System, request: ScanQuestion) -> tuple[Variant, ...]:
    for name in request.named_variants:
        if name not in system.variants:
            raise UserError(f"{system.name}: {unknown('variant', name, system.variants)}")
    if request.repair == request.variant:
        raise UserError(
            f"the scan and its repair are both '{request.repair}': name two different variants."
        )
    return tuple(system.variants[name] for name in request.named_variants)


def _nothing_sized(system: System, every: Sequence[Candidate]) -> UserError:
    if not every:
        return UserError(f"{system.name}: no version reads a source that may err: nothing to scan.")
    why = "; ".join(f"{candidate.name} {candidate.unsized}" for candidate in every)
    channel = next((c for candidate in every for c in candidate.channels), "CHANNEL")
    return UserError(
        f"{system.name}: no source says how large its errors are ({why}): declare it in the "
        f"interface, or give the expected error, for example --fault {channel}:scale=1.1"
    )
