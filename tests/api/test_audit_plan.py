"""Which treatments a question needs, which are one and the same, and which taps they faulted."""

import pytest
from still import Still
from toy_audits import TOY

from faultpath.analyses.audit import AuditAnalysis, audit_analysis
from faultpath.analyses.model import FaultedTap
from faultpath.core.errors import UserError
from faultpath.faults import Fault, FaultText, Scale
from faultpath.interface import read_interface
from faultpath.run.execution.runner import run_plan
from faultpath.run.plan import SystemSpec
from faultpath.run.question import (
    AuditQuestion,
    CheckQuestion,
    MapQuestion,
    ScanQuestion,
    TraceQuestion,
)
from faultpath.run.registry import load_system
from faultpath.system import Status, Variant

FACTS = """
name: paper
sources:
- {name: scale_reading, unit: kg, provenance: measured}
- {name: thermometer, unit: K, provenance: measured}
channels:
- name: mass
  sources: [scale_reading]
  readers: [planner.cost, planner.limit, observer.model, logger.file]
- {name: heat, sources: [thermometer], readers: [logger.file]}
"""


def halve(size: float) -> tuple[Fault, ...]:
    scale = Scale(factor=size)
    return tuple(Fault(channel=name, intervention=scale) for name in ("mass", "heat"))


READS = {
    "plain": {"planner.cost", "planner.limit"},
    "limited": {"planner.limit"},
    "observed": {"planner.cost", "planner.limit", "observer.model"},
    "deaf": set(),
    "logged": {"logger.file"},
}


class Paper(Still):
    name, interface = "paper", read_interface(FACTS)
    variants = {name: Variant(name, name, frozenset(reads)) for name, reads in READS.items()}  # noqa: RUF012 - never changed
    fault_presets = {"both": halve}  # noqa: RUF012 - never changed


def planned(baseline: str, repair: str, text: str, **changes) -> AuditAnalysis:
    system = Paper()
    return audit_analysis(
        system,
        SystemSpec(name="paper"),
        AuditQuestion(baseline=baseline, repair=repair, fault=FaultText.read(text), **changes),
        system.library("five"),
    )


COST, LIMIT, MODEL = ("mass", "planner.cost"), ("mass", "planner.limit"), ("mass", "observer.model")
LOG, HEAT = ("mass", "logger.file"), ("heat", "logger.file")
NONE: set[tuple[str, str]] = set()
LAID_OUT = {
    "two modules": (
        ("plain", "observed", "mass:scale=2"),
        {
            "correct": (NONE, NONE),
            "observer": ({MODEL}, NONE),
            "planner": ({COST, LIMIT}, {COST, LIMIT}),
            "shared": ({COST, LIMIT, MODEL}, {COST, LIMIT}),
        },
    ),
    "one module is not shared": (
        ("limited", "plain", "mass:scale=2"),
        {"correct": (NONE, NONE), "planner": ({COST, LIMIT}, {LIMIT})},
    ),
    "a named module": (
        ("plain", "observed", "mass:scale=2@observer"),
        {"correct": (NONE, NONE), "observer": ({MODEL}, NONE)},
    ),
    "named taps": (
        ("plain", "observed", "mass:scale=2@planner.cost+observer"),
        {
            "correct": (NONE, NONE),
            "observer": ({MODEL}, NONE),
            "planner": ({COST}, {COST}),
            "shared": ({COST, MODEL}, {COST}),
        },
    ),
    "coupled": (
        ("deaf", "logged", "both=0.5"),
        {"correct": (NONE, NONE), "logger": ({LOG, HEAT}, NONE)},
    ),
}


def _faulted(audit: AuditAnalysis, variant: str, condition: str) -> set[tuple[str, str]]:
    (row,) = (r for r in audit.plan.rows if (r.variant, r.condition) == (variant, condition))
    return {(fault.channel, c) for fault in row.treatment.faults for c in fault.readers}


@pytest.mark.parametrize(("question", "conditions"), LAID_OUT.values(), ids=LAID_OUT)
def test_each_condition_strikes_the_places_that_it_names_in_either_variant(question, conditions):
    audit = planned(*question)
    assert [condition.name for condition in audit.conditions] == list(conditions)
    for condition in audit.conditions:
        repair, baseline = conditions[condition.name]
        assert _faulted(audit, audit.question.repair, condition.name) == repair
        assert _faulted(audit, audit.question.baseline, condition.name) == baseline
        assert set(condition.readers) == {reader for _, reader in repair}
        assert set(condition.baseline_readers) == {reader for _, reader in baseline}


def test_every_cell_has_a_row_and_treatments_that_are_the_same_run_once():
    audit = planned("plain", "observed", "mass:scale=2", seeds=(0, 7))
    rows = {(row.variant, row.condition, row.seed): row.treatment for row in audit.plan.rows}
    assert len(rows) == len(audit.plan.rows) == 2 * 4 * 2
    for seed in (0, 7):
        # Without an observer there is nobody to strike: its trials under correct inputs stand in.
        assert rows["plain", "observer", seed] == rows["plain", "correct", seed]
        assert rows["plain", "planner", seed] == rows["plain", "shared", seed]
        assert all(rows[key].seed == seed for key in rows if key[2] == seed)
    keys = {treatment.key() for treatment in rows.values()}
    assert len(audit.plan.treatments()) == len(keys) == 2 * (2 + 4)


def test_the_question_says_what_was_asked():
    audit = planned("plain", "observed", "mass:scale=2,onset=3", scenes=2, seeds=(4,))
    question, facts = audit.question, audit.facts
    assert (question.baseline, question.repair) == ("plain", "observed")
    assert str(question.fault) == "mass:scale=2,onset=3"
    assert (facts.library, facts.library_hash) == ("five", "five-1")
    assert (facts.n_scenes, question.seeds) == (2, (4,))
    assert audit.plan.scenes == ("s0", "s1")
    faults = [fault for row in audit.plan.rows for fault in row.treatment.faults]
    assert faults
    assert all(fault.onset_step == 3 for fault in faults)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (("plian", "observed", "mass:scale=2"), "'plian'.*'plain'.*deaf, limited, logged"),
        (("plain", "plain", "mass:scale=2"), "both 'plain'.*two different"),
        (("deaf", "limited", "mass:scale=2@observer"), "neither 'deaf' nor 'limited'"),
        (("deaf", "plain", "heat:scale=2"), "heat.*neither 'deaf' nor 'plain'"),
    ],
)
def test_questions_that_cannot_be_asked(call, sentence):
    with pytest.raises(UserError, match=sentence):
        planned(*call)


@pytest.mark.parametrize("count", [0, 6])
def test_scenes_that_the_library_does_not_have(count):
    assert len(planned("plain", "observed", "mass:scale=2").plan.scenes) == 5
    with pytest.raises(UserError, match=f"{count} scenes of library 'five': choose 1 to 5"):
        planned("plain", "observed", "mass:scale=2", scenes=count)


def test_a_module_may_not_be_called_like_a_condition(monkeypatch):
    document = FACTS.replace("observer.model", "shared.model")
    monkeypatch.setattr(Paper, "interface", read_interface(document))
    reads = frozenset({"planner.cost", "shared.model"})
    monkeypatch.setitem(Paper.variants, "observed", Variant("observed", "", reads))
    with pytest.raises(UserError, match="calls a module 'shared'"):
        planned("plain", "observed", "mass:scale=2")


def test_the_question_names_its_primary_contrast_and_what_it_generalises_to():
    assert planned("plain", "observed", "mass:scale=2").facts.primary == "shared"
    assert planned("deaf", "plain", "mass:scale=2").facts.primary == "planner"
    named = planned("plain", "observed", "mass:scale=2", primary="observer")
    assert (named.facts.primary, named.facts.trained) == ("observer", False)
    assert named.question.generalise == "scenes"
    with pytest.raises(
        UserError, match=r"no condition 'pilot'.*correct, observer, planner, shared"
    ):
        planned("plain", "observed", "mass:scale=2", primary="pilot")


def test_newly_trained_models_need_trained_models_and_several_seeds(monkeypatch):
    models = {"generalise": "models", "seeds": (0, 1, 2, 3, 4)}
    with pytest.raises(UserError, match="no trained models to generalise to"):
        planned("plain", "observed", "mass:scale=2", **models)
    monkeypatch.setattr(Paper, "trained", True)
    audit = planned("plain", "observed", "mass:scale=2", **models)
    assert (audit.question.generalise, audit.facts.trained) == ("models", True)
    with pytest.raises(UserError, match=r"4 seeds cannot show how .*--seeds 0,1,2,3,4"):
        planned("plain", "observed", "mass:scale=2", generalise="models", seeds=(0, 1, 2, 3))


def test_the_question_knows_what_the_system_calls_its_ends(monkeypatch):
    monkeypatch.setattr(Paper, "ends", {Status.TIMEOUT: "missed"})
    assert planned("plain", "observed", "mass:scale=2").facts.ends == {"timeout": "missed"}


def test_audits_and_maps_run_in_scenes_that_nothing_was_chosen_by() -> None:
    """All else, in those of selection."""
    questions = (AuditQuestion, MapQuestion, ScanQuestion, CheckQuestion, TraceQuestion)
    libraries = [question.model_fields["library"].default for question in questions]
    assert libraries == ["held-out", "held-out", "selection", "selection", "selection"]


@pytest.mark.parametrize(
    ("text", "in_force", "altered"),
    [
        ("gain:scale=0.6", 100, 100),
        ("gain:scale=0.6,onset=90", 10, 10),
        ("gain:scale=1", 100, 0),
        ("gain:scale=0.6,onset=100", 0, 0),
    ],
    ids=["always", "late", "without an effect", "after the end"],
)
def test_the_result_has_the_taps_that_the_delivery_log_says_were_faulted(
    tmp_path, text, in_force, altered
):
    spec, fault = SystemSpec(name=TOY), FaultText.read(text)
    question = AuditQuestion(baseline="calibrated", repair="blind", fault=fault, scenes=4)
    system = load_system(spec)
    audit = audit_analysis(system, spec, question, system.library("carts"))
    run = run_plan(audit.plan, tmp_path, workers=0)
    controller, observer = (
        (
            FaultedTap(
                channel="gain", reader=reader, faulted_steps=4 * in_force, altered_steps=4 * altered
            ),
        )
        * (in_force > 0)
        for reader in ("controller.inverse", "observer.model")
    )
    conditions = audit.conclude(run.trials, run.deliveries).conditions
    assert {of.name: (of.faulted, of.baseline_faulted) for of in conditions} == {
        "correct": ((), ()),
        "controller": (controller, controller),
        "observer": ((), observer),
        "shared": (controller, controller + observer),
    }
