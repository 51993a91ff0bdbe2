"""A plan: sources in order, the audits of a study, how many trials they take and how long."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from faultpath.core.errors import UserError
from faultpath.core.results import Result
from faultpath.decisions.plan.order import makers, ranked, recursion, repaired_modules
from faultpath.decisions.plan.probing import command_responses
from faultpath.decisions.plan.sources import Candidate, candidates
from faultpath.decisions.plan.study import StudyAudit, StudyFile, arms_of
from faultpath.decisions.planning import Audit, plan_audit, two_variants
from faultpath.trials import Arm, Library, LoopSystem, System, SystemSpec, Variant
from faultpath.trials.question import PlanQuestion

PROBED_SCENES = 5
"""A probe is a look at where to begin, and no result."""
Note = Callable[[int, int], None]
"""Takes how many flights are done, and of how many."""


class Plan(Result):
    """What `faultpath plan --json` prints."""

    format: int = 1
    study: StudyFile
    candidates: tuple[Candidate, ...]
    """Ranked, those that have no fault and so no audit included."""
    repaired: tuple[str, ...]
    """Modules that the repair changes, as far as is known."""
    unplanned: dict[str, str]
    """Sources that the recursion leads to and that have no fault, each with why it leads there."""
    probed: int
    """Scenes of the probe; 0 where there was none."""
    trials: tuple[int, ...]
    """Of each audit, beyond those that an earlier one flies."""


@dataclass(frozen=True)
class Proposal:
    """What is asked for, and the system that is asked."""

    system: System
    spec: SystemSpec
    asked: PlanQuestion
    library: Library
    variants: tuple[Variant, Variant] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "variants", two_variants(self.system, self.asked))

    def make(self, note: Note = lambda done, total: None) -> Plan:
        """Rank, probe and lay the audits out.

        `UserError` for anything that `plan_audit` refuses, where no source has a fault, and for a
        variant that does not run.
        """
        found = candidates(self.system, self.variants, self.asked.fault)
        if not any(each.fault for each in found):
            raise UserError(_nothing_sized(self.system, found))
        repaired = repaired_modules(self.system, *self.variants, self.asked.module)
        chosen = self._audit(next(each for each in found if each.fault)).study.scenes
        probes = isinstance(self.system, LoopSystem) and sum(bool(c.fault) for c in found) > 1
        if isinstance(self.system, LoopSystem) and probes:
            for done, variant in enumerate(self.variants):
                note(done, len(self.variants))
                found = self._probed(self.system, found, variant.name, chosen[:PROBED_SCENES])
        order = ranked(found)
        first, why = self._reasons(order, repaired)
        named = [each for each in order if each.fault and each.name in why]
        named.sort(key=lambda each: each.name != first)
        laid = [self._audit(each) for each in named]
        fresh = _fresh(laid)
        return Plan(
            study=StudyFile(
                system=self.spec.name,
                options=self.spec.options,
                baseline=self.asked.baseline,
                repair=self.asked.repair,
                library=self.library.name,
                library_hash=self.library.content_hash,
                scenes=len(chosen),
                seeds=self.asked.seeds,
                audits=tuple(
                    StudyAudit(
                        name=each.name,
                        fault=each.fault,
                        why=why[each.name],
                        arms=arms_of(audit, repaired),
                    )
                    for each, audit in zip(named, laid, strict=True)
                ),
            ),
            candidates=order,
            repaired=repaired,
            unplanned={c.name: why[c.name] for c in order if c.name in why and not c.fault},
            probed=min(len(chosen), PROBED_SCENES) if probes else 0,
            trials=tuple(len(arms) * len(chosen) for arms in fresh),
        )

    def _audit(self, each: Candidate) -> Audit:
        asked = self.asked.audit_of(each.fault)
        return plan_audit(self.system, self.spec, asked, self.library)

    def _probed(
        self,
        system: LoopSystem,
        found: Sequence[Candidate],
        variant: str,
        scenes: Sequence[str],
    ) -> tuple[Candidate, ...]:
        arms = {
            (each.name, row.path): row.arm.faults
            for each in found
            if each.fault
            for row in self._audit(each).study.rows
            if row.variant == variant and row.arm.faults
        }
        moved = command_responses(system, variant, arms, scenes, self.asked.seeds[0])

        def responses(name: str) -> dict[str, float]:
            return {path: value for (source, path), value in moved.items() if source == name}

        return tuple(
            each.model_copy(update={"responses": each.responses | {variant: responses(each.name)}})
            for each in found
        )

    def _reasons(
        self, order: Sequence[Candidate], repaired: tuple[str, ...]
    ) -> tuple[str, dict[str, str]]:
        first = next(each for each in order if each.fault)
        by_rank = "first by rank" if first is order[0] else "first with an expected error"
        struck = tuple(dict.fromkeys(c.partition(".")[0] for c in first.consumers))
        made_by = makers(self.system.interface, self.variants)
        more = recursion(order, made_by, (*repaired, *struck))
        return first.name, {first.name: by_rank} | {
            name: why for name, why in more.items() if name != first.name
        }


def _fresh(laid: Sequence[Audit]) -> list[list[Arm]]:
    """Return the arms of each audit that the first one has not got: those it shares are taken
    over."""
    held = {arm.key() for arm in laid[0].study.arms()}
    more = ([a for a in each.study.arms() if a.key() not in held] for each in laid[1:])
    return [list(laid[0].study.arms()), *more]


def _nothing_sized(system: System, found: Sequence[Candidate]) -> str:
    if not found:
        return f"{system.name}: neither variant reads a source that may err: nothing to plan."
    why = "; ".join(f"{each.name} {each.unsized}" for each in found)
    channel = next((c for each in found for c in each.channels), "CHANNEL")
    return (
        f"{system.name}: no source says how large its errors are ({why}): declare it in the "
        f"interface, or give the expected error, for example --fault {channel}:scale=1.1"
    )
