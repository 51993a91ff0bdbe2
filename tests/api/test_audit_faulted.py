"""The record says which taps were faulted: from the delivery log, not from the plan."""

import pytest
from toy_audits import TOY

from faultpath.analyses.audit import AuditAnalysis, audit_analysis
from faultpath.analyses.model import AuditResult, FaultedTap
from faultpath.faults import FaultText
from faultpath.run.execution.runner import run_plan
from faultpath.run.plan import SystemSpec
from faultpath.run.question import AuditQuestion
from faultpath.run.registry import load_system

STEPS = 100


def asked(text: str) -> AuditAnalysis:
    spec = SystemSpec(name=TOY)
    system = load_system(spec)
    fault = FaultText.read(text)
    question = AuditQuestion(baseline="calibrated", repair="blind", fault=fault, scenes=4)
    return audit_analysis(system, spec, question, system.library("carts"))


def faulted(record: AuditResult) -> dict[str, tuple[tuple[FaultedTap, ...], ...]]:
    return {
        condition.name: (condition.faulted, condition.baseline_faulted)
        for condition in record.conditions
    }


def tap(reader: str, faulted_steps: int, altered_steps: int) -> FaultedTap:
    return FaultedTap(
        channel="gain", reader=reader, faulted_steps=faulted_steps, altered_steps=altered_steps
    )


@pytest.mark.parametrize(
    ("text", "in_force", "altered"),
    [
        ("gain:scale=0.6", STEPS, STEPS),
        ("gain:scale=0.6,onset=90", 10, 10),
        ("gain:scale=1", STEPS, 0),
    ],
)
def test_a_path_holds_the_taps_faulted_in_either_variant(tmp_path, text, in_force, altered):
    audit = asked(text)
    result = run_plan(audit.plan, tmp_path, workers=0)
    controller = tap("controller.inverse", 4 * in_force, 4 * altered)
    observer = tap("observer.model", 4 * in_force, 4 * altered)
    assert faulted(audit.conclude(result.trials, result.deliveries)) == {
        "correct": ((), ()),
        "controller": ((controller,), (controller,)),
        "observer": ((), (observer,)),
        "shared": ((controller,), (controller, observer)),
    }


def test_a_fault_after_the_end_faulted_nothing(tmp_path):
    audit = asked("gain:scale=0.6,onset=100")
    result = run_plan(audit.plan, tmp_path, workers=0)
    record = audit.conclude(result.trials, result.deliveries)
    assert set(faulted(record).values()) == {((), ())}
