"""The analysis of an audit: both variants under each condition of a fault, in one round."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import PurePath

from faultpath.analyses.analysis import (
    ORDER_SEED,
    Analysis,
    Round,
    Rounds,
    faults_by_condition,
    rows_of,
    scenes_of,
    two_variants,
)
from faultpath.analyses.decide import decide, primary_condition, stops
from faultpath.analyses.facts import ComparisonFacts, SceneOrder, facts_of, question_of
from faultpath.analyses.model import AuditResult, Condition, FaultedTap, title_of
from faultpath.core.errors import UserError
from faultpath.core.text import counted, unknown
from faultpath.faults import Fault
from faultpath.loop import TapCount
from faultpath.run.deliveries import Deliveries
from faultpath.run.plan import Plan, SystemSpec
from faultpath.run.question import FEWEST_TRAININGS, AuditQuestion
from faultpath.run.trials import Trials
from faultpath.system.declared import Library
from faultpath.system.system import System

_BATCH = 5
"""Scenes from one analysis to the next of a sequential audit, where the system runs as many at
once: fewer save few trials and cost much for systems that run their scenes together."""


@dataclass(frozen=True)
class AuditAnalysis(Analysis[None]):
    """A question and the plan that answers it."""

    question: AuditQuestion
    facts: ComparisonFacts
    conditions: tuple[Condition, ...]
    plan: Plan

    def rounds(self) -> Rounds[None]:
        """Yield the only round."""
        stop = partial(stops, self.question, self.facts, self.conditions)
        yield Round(self.plan, stop=stop)

    def conclude(self, trials: Trials, deliveries: Deliveries, items: None = None) -> AuditResult:
        """Return the result of an audit; raises as `faultpath.analyses.decide.decide`."""

        def faulted(variant: str, condition: Condition) -> tuple[FaultedTap, ...]:
            return faulted_taps(deliveries.at(variant, condition.name))

        repair, baseline = self.question.repair, self.question.baseline
        conditions = [
            condition.model_copy(
                update={
                    "faulted": faulted(repair, condition),
                    "baseline_faulted": faulted(baseline, condition),
                }
            )
            for condition in self.conditions
        ]
        return decide(self.question, self.facts, conditions, trials, deliveries.findings)


def faulted_taps(counts: Sequence[TapCount]) -> tuple[FaultedTap, ...]:
    """Return the taps at which the delivery log shows a fault in force."""
    return tuple(
        FaultedTap(
            channel=tap.channel,
            reader=tap.reader,
            faulted_steps=tap.faulted_steps,
            altered_steps=tap.altered_steps,
        )
        for tap in counts
        if tap.faulted_steps
    )


def audit_analysis(
    system: System, spec: SystemSpec, request: AuditQuestion, library: Library
) -> AuditAnalysis:
    """Lay out the treatments: both variants under correct inputs, under the fault at each module
    that reads it alone, and under the fault shared by all of them.

    The primary condition, which leads the headline, is by default the shared one, or the only
    isolated one.

    Raises `UserError` for an unknown variant or metric, a repair that is its own baseline, a number
    of scenes that the library does not have, a fault that reaches neither variant, a primary
    condition that does not exist, newly trained models of a system that trains none, from one seed
    or in a sequential audit, or a margin that is none.
    """
    variants = two_variants(system, request)
    sequential = request.stop_when is not None
    scenes = scenes_of(library, request.scenes, in_order=not sequential)
    faults = system.fault(request.fault)
    by_condition = faults_by_condition(faults, variants)
    conditions = tuple(
        _condition(name, by_variant[request.repair], by_variant[request.baseline])
        for name, by_variant in by_condition.items()
    )
    _check(system, request)
    plan = Plan(
        name=f"{spec.name}-{request.repair}-vs-{request.baseline}",
        system=spec,
        library=library.name,
        scenes=scenes,
        # A variant that the fault cannot reach has the treatment under correct inputs, run once.
        rows=tuple(
            row
            for condition, by_variant in by_condition.items()
            for row in rows_of(condition, by_variant, request.seeds)
        ),
        scenes_per_analysis=min(_BATCH, system.block_size or _BATCH) if sequential else 0,
    )
    order = SceneOrder(
        scenes=scenes,
        seed=ORDER_SEED,
        per_analysis=plan.scenes_per_analysis,
        trials=len(plan.treatments()),
    )
    facts = ComparisonFacts(
        **facts_of(system, spec, library),
        n_scenes=len(scenes),
        seeds=request.seeds,
        primary=primary_condition(request.primary or "", conditions),
        faults=faults,
        ends={status.value: words for status, words in system.ends.items()},
        metrics=dict(system.metrics),
        order=order if sequential else None,
    )
    named = [plan.name, str(request.fault), PurePath(library.name).stem]
    if request.stop_when is not None:
        small = "" if request.margin_pp is None else f"-within-{request.margin_pp:g}"
        named.append(f"until-{request.stop_when}{small}")
    question = question_of(request, AuditQuestion, spec)
    return AuditAnalysis(question, system, tuple(named), facts, conditions, plan)


def _condition(name: str, repair: Sequence[Fault], baseline: Sequence[Fault]) -> Condition:
    readers, baseline_readers = (
        tuple(dict.fromkeys(reader for fault in faults for reader in fault.readers))
        for faults in (repair, baseline)
    )
    return Condition(
        name=name, title=title_of(name), readers=readers, baseline_readers=baseline_readers
    )


def _check(system: System, question: AuditQuestion) -> None:
    """Raise `UserError` for a metric, a margin or a population that means nothing."""
    if question.thresholds and not question.metric:
        raise UserError("thresholds of what? Name a metric of the system beside them.")
    if question.metric and question.metric not in system.metrics:
        raise UserError(f"{system.name}: {unknown('metric', question.metric, system.metrics)}")
    margin = question.margin_pp
    if margin is not None and not (question.stop_when and 0.0 < margin < 100.0):
        raise UserError(
            f"a margin of {margin:g} pp says when a sequential audit counts a difference as "
            "none: give it with --stop-when, between 0 and 100."
        )
    if question.generalise != "models":
        return
    if question.stop_when:
        raise UserError(
            "no test of newly trained models holds wherever one stops: leave --stop-when or "
            "--generalise models out."
        )
    if not system.trained:
        raise UserError(
            f"{system.name} has no trained models to generalise to: leave --generalise models out."
        )
    if len(question.seeds) < FEWEST_TRAININGS:
        raise UserError(
            f"{counted(len(question.seeds), 'seed')} cannot show how newly trained models would "
            f"spread: give {FEWEST_TRAININGS} or more, such as --seeds 0,1,2,3,4, or leave "
            "--generalise models out."
        )
