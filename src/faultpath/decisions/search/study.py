"""Question of a search, and the trials in which a fault is tried, or put to the test."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath

import numpy as np

from faultpath.core.errors import UserError
from faultpath.core.streams import generator
from faultpath.core.text import listed
from faultpath.decisions.analysis import Analysis, Round, Rounds
from faultpath.decisions.fault_groups import fault_of
from faultpath.decisions.model import CORRECT, SHARED, DecisionRecord
from faultpath.decisions.planning import (
    Audit,
    faults_by_path,
    plan_audit,
    rows_of,
    scenes_of,
    two_variants,
)
from faultpath.decisions.question import resolve
from faultpath.decisions.search.bounds import read_bounds
from faultpath.decisions.search.decide import conclude
from faultpath.decisions.search.model import ResolvedSearch, SearchRecord, Tried
from faultpath.decisions.search.propose import proposals
from faultpath.statistics.distributions import sign_p_value
from faultpath.statistics.estimate import ALPHA
from faultpath.statistics.inputs import Floats
from faultpath.trials import Deliveries, Library, OutcomeTable, Row, Study, System, SystemSpec
from faultpath.trials.pairing import Side, pair
from faultpath.trials.question import SearchQuestion


@dataclass(frozen=True)
class SearchPlan(Analysis[list[Tried]]):
    """A question, and the trials of any fault within its bounds."""

    noun = "faults"

    request: SearchQuestion
    question: ResolvedSearch
    spec: SystemSpec
    library: Library = field(repr=False)
    finding: tuple[str, ...] = field(repr=False)
    confirming: tuple[str, ...] = field(repr=False)

    def rounds(self) -> Rounds[list[Tried]]:
        """Yield the faults that are spread evenly, then those which what was seen leads to."""
        question, bounds, tried = self.question, self.question.bounds, dict[str, Tried]()
        source = proposals(len(bounds.ranges()), question.search_seed, question.candidates)
        batch = [bounds.fault(point) for point in next(source)]
        per_fault = len(self.study(batch[:1]).rows) * question.finding
        notice = (
            f"{question.candidates} faults are tried in {question.finding} scenes, {per_fault} "
            f"trials each at most; then one is put to the test in {question.confirming} other "
            "scenes."
        )
        faults = list(dict.fromkeys(batch))
        while True:
            table = yield Round(self.study(faults), len(faults), question.candidates, notice)
            new, notice = list[str](), ""
            while not new:
                tried.update({f: self.tried(f, table) for f in batch if f not in tried})
                try:
                    points = source.send([tried[fault].regret_pp for fault in batch])
                except StopIteration:
                    return list(tried.values())
                batch = [bounds.fault(point) for point in points]
                new = [fault for fault in dict.fromkeys(batch) if fault not in tried]
            faults += new

    def conclude(
        self,
        table: OutcomeTable,
        deliveries: Deliveries,
        items: Sequence[Tried],
        confirmed: DecisionRecord | None = None,
        confirmation: str = "",
        failed: int = 0,
    ) -> SearchRecord:
        """Return the record, with the audit that confirms, its folder and its failed trials."""
        failed += len(table.failed())
        findings = deliveries.findings
        return conclude(self.question, items, confirmed, confirmation, failed, findings)

    def study(self, faults: Sequence[str]) -> Study:
        """Return the study of faults in the scenes that find: both variants, with each at the
        isolated module alone and with it shared. An arm that it cannot reach runs once for all."""
        question, rows = self.question, list[Row]()
        variants = two_variants(self.system, self.request)
        for text in faults:
            paths = faults_by_path(self.system, fault_of(self.system, text), variants)
            for path in (question.bounds.isolated, SHARED):
                rows += rows_of(f"{path}: {text}", paths[path], question.seeds)
        return Study(
            name=self.named[0],
            system=self.spec,
            library=question.library,
            scenes=self.finding,
            rows=tuple(rows),
        )

    def tried(self, fault: str, table: OutcomeTable) -> Tried:
        """Return what the scenes that find show of a fault; nothing without a pair of trials."""
        question, ahead = self.question, list[Floats]()
        for path in (question.bounds.isolated, SHARED):
            at = f"{path}: {fault}"
            pairs = pair(table, Side(question.repair, at), Side(question.baseline, at))
            difference = pairs.first.success.astype(np.float64) - pairs.second.success
            ahead.append(difference.mean(axis=1) if len(pairs.scenes) else np.zeros(1))
        isolated, shared = ahead
        return Tried(
            fault=fault,
            isolated_pp=100.0 * float(isolated.mean()),
            shared_pp=100.0 * float(shared.mean()),
            regret_pp=100.0 * regret(isolated, shared),
        )

    def audit(self, fault: str) -> Audit:
        """Return the audit of a fault in the scenes that confirm."""
        scenes = tuple(scene for scene in self.library.scenes if scene.id in self.confirming)
        question = self.request.audit_of(fault).model_copy(update={"scenes": None})
        return plan_audit(self.system, self.spec, question, replace(self.library, scenes=scenes))


def digest(text: str) -> str:
    """Return a few letters that stand for a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def regret(isolated: Floats, shared: Floats) -> float:
    """Return what the choice by the isolated fault loses under the shared one, a fraction, from
    the differences of scenes `[scenes]`.

    Where the lead is not clear in these scenes no isolated audit would choose by it, and no more
    counts than there is of it.
    """
    lead = float(isolated.mean())
    lost = -float(np.sign(lead)) * float(shared.mean())
    clear = sign_p_value(int((isolated > 0).sum()), int((isolated < 0).sum())) <= ALPHA
    return lost if clear else min(abs(lead), lost)


def halves(library: Library, count: int | None) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the scenes that find and those that confirm: of two neighbours in the library one
    each, by coins that know only the library, so that neither the number of scenes nor the seed
    of a search moves a scene into the other half.

    `UserError` for a number of scenes that the library has not got, or that leaves a half empty.
    """
    chosen = scenes_of(library, count)
    if len(chosen) < 2:
        raise UserError(
            "one scene cannot both find a fault and confirm it: give 2 --scenes or more."
        )
    coins = generator("search halves", library.content_hash, 0).integers(2, size=len(chosen))
    sides = [(i + int(coins[i // 2])) % 2 for i in range(len(chosen))]
    finding, confirming = (
        tuple(scene for scene, of in zip(chosen, sides, strict=True) if of == side)
        for side in (0, 1)
    )
    return finding, confirming


def plan_search(
    system: System, spec: SystemSpec, request: SearchQuestion, library: Library
) -> SearchPlan:
    """Lay out a search. `UserError` for anything that cannot be run or means nothing."""
    variants = two_variants(system, request)
    bounds = read_bounds(request.within, system)
    for corner in (0.0, 1.0):
        fault = fault_of(system, bounds.fault([corner] * len(bounds.ranges())))
        paths = faults_by_path(system, fault, variants)
        alone = [path for path in paths if path not in (CORRECT, SHARED)]
        if SHARED not in paths:
            raise UserError(
                f"{request.within}: only the {listed(alone)} gets this fault, so that nothing is "
                "shared: name a channel that several modules read."
            )
        if bounds.isolated not in alone:
            raise UserError(
                f"{request.within}: isolated: '{bounds.isolated}' is no module that gets the "
                f"fault: name one of {listed(alone)}."
            )
    finding, confirming = halves(library, request.scenes)
    question = resolve(
        ResolvedSearch,
        request,
        spec,
        library,
        bounds=bounds,
        finding=len(finding),
        confirming=len(confirming),
    )
    named = (
        f"{spec.name}-search-{request.repair}-vs-{request.baseline}",
        f"{request.within.stem}-{digest(bounds.model_dump_json())}",
        f"{request.candidates}-faults-seed-{request.search_seed}",
        PurePath(request.library).stem,
    )
    return SearchPlan(request, question, system, named, spec, library, finding, confirming)
